// A wall clock of one's own, for whatever is started with this library preloaded: it shows as many nanoseconds more than
// that of the machine as the file says whose name is in WALL_CLOCK (a signed number of 8 bytes). The file may be written
// to while the process runs: then the clock steps. Monotonic clocks stay as they are.
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace {

constexpr std::int64_t SECOND = 1'000'000'000;

const volatile std::int64_t* mapped() {
    const char* name = std::getenv("WALL_CLOCK");
    const int file = name == nullptr ? -1 : open(name, O_RDONLY | O_CLOEXEC);
    if (file < 0) return nullptr;
    void* const at = mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    close(file);
    return at == MAP_FAILED ? nullptr : static_cast<const volatile std::int64_t*>(at);
}

std::int64_t ahead() {
    static const volatile std::int64_t* const shown = mapped();
    return shown == nullptr ? 0 : *shown;
}

}  // namespace

extern "C" int clock_gettime(clockid_t clock, timespec* t) noexcept {
    static const auto real = reinterpret_cast<int (*)(clockid_t, timespec*)>(dlsym(RTLD_NEXT, "clock_gettime"));
    const int result = real(clock, t);
    if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE)) {
        const std::int64_t shown = t->tv_sec * SECOND + t->tv_nsec + ahead();
        t->tv_sec = shown / SECOND;
        t->tv_nsec = shown % SECOND;
    }
    return result;
}

extern "C" int gettimeofday(timeval* t, void*) noexcept {
    timespec now{};
    const int result = clock_gettime(CLOCK_REALTIME, &now);
    t->tv_sec = now.tv_sec;
    t->tv_usec = now.tv_nsec / 1000;
    return result;
}

extern "C" time_t time(time_t* to) noexcept {
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    if (to != nullptr) *to = now.tv_sec;
    return now.tv_sec;
}
