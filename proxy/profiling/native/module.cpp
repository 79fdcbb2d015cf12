// proxy.profiling._native: has threads look at themselves, each after so much of its own processor time.
//
// The kernel's timers run on the processor time of one thread, and their signal comes to that thread, where it runs at
// that moment. It reads its own frames then, without Python's lock: so nobody waits for anybody, and a thread that
// waits is never woken. All memory is read through the kernel, for which what is not there is no fault: the thread may
// be about to change what is read.
#include <nanobind/nanobind.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <signal.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace nb = nanobind;
using namespace nb::literals;

namespace {

using Word = std::uint64_t;
using Stack = std::vector<Word>;

constexpr std::size_t depth = 64;          // frames of a stack, the innermost
constexpr std::size_t frame_words = 8;     // of a frame, in which layout.py finds its code and who called it
constexpr std::size_t state_words = 40;    // of a thread's state, in which layout.py finds the rest
constexpr std::size_t most_threads = 1024;
constexpr std::size_t most_looks = 2048;   // between two times that they are gathered
constexpr std::size_t most_stacks = 8192;  // what is seen beyond them counts for the outermost function only
constexpr Word tags = 7;                   // pointers to code may be marked in their lowest bits

// Where Python keeps what a thread does, in words: found out by layout.py. `inner` is negative where the current frame
// stands in the state of the thread itself.
struct Layout {
    Word oldest;  // the state of the thread that outlives all others
    int newer, native, current, inner, code, previous;
};

// A thread, by the kernel's number; what it had taken of the processor when it was seen first and last [s].
struct Thread {
    Word native = 0;
    double first = 0.0, last = 0.0;
    bool ticks = false;
    timer_t timer{};
};

enum class Slot { empty, written, full };

// Where a thread was when it looked. A slot is filled by one thread and emptied by another, none of which waits.
struct Look {
    std::atomic<Slot> slot{Slot::empty};
    Word native = 0;
    std::size_t size = 0;
    std::array<Word, depth> stack{};
};

clockid_t clock_of(Word native) { return static_cast<clockid_t>((~static_cast<std::int64_t>(native) << 3) | 6); }

// Return what a clock shows [s]; negative where it is none, as that of a thread that has ended.
double seconds(clockid_t which) {
    timespec now{};
    const bool known = clock_gettime(which, &now) == 0;
    return known ? static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec) : -1.0;
}

bool read(Word address, Word* into, std::size_t words) {
    const iovec local{into, words * sizeof(Word)};
    const iovec remote{reinterpret_cast<void*>(address), words * sizeof(Word)};
    return address != 0 && process_vm_readv(getpid(), &local, 1, &remote, 1, 0) == static_cast<ssize_t>(local.iov_len);
}

// Samples the threads that it is told of, until it is stopped. There is one at a time.
class Sampler {
public:
    // A thread looks after each `period` of its processor time [s]; the kernel asks no more often than its clock ticks.
    Sampler(Layout layout, double period) : layout_(layout), period_(period), looks_(new Look[most_looks]) {
        struct sigaction action {};
        action.sa_sigaction = [](int, siginfo_t* info, void*) { signalled(info); };
        action.sa_flags = SA_SIGINFO | SA_RESTART;
        sigemptyset(&action.sa_mask);
        sigaction(SIGPROF, &action, nullptr);  // and for good: a signal may still be on its way when we stop
        active.store(this);
    }

    Sampler(const Sampler&) = delete;
    Sampler& operator=(const Sampler&) = delete;

    ~Sampler() { stop(); }

    // Sample these threads, too; what one has taken before counts if it is `fresh`.
    void watch(const std::vector<Word>& natives, bool fresh) {
        for (const Word native : natives) {
            const double taken = seconds(clock_of(native));
            if (taken < 0.0 || threads_.count(native)) continue;
            Thread& thread = threads_[native];
            thread.native = native;
            thread.first = fresh ? 0.0 : taken;
            thread.last = taken;
            thread.ticks = start_timer(thread);
        }
    }

    // Let no thread look any more.
    void stop() {
        for (auto& [native, thread] : threads_) {
            if (!thread.ticks) continue;
            timer_delete(thread.timer);
            thread.ticks = false;
            thread.last = std::fmax(thread.last, seconds(clock_of(native)));
        }
        Sampler* self = this;
        active.compare_exchange_strong(self, nullptr);
        while (looking.load() != 0) std::this_thread::yield();
    }

    // Take in what was seen since the last time; return the functions that are new.
    Stack gather() {
        Stack fresh;
        for (std::size_t at = 0; at < most_looks; ++at) {
            Look& look = looks_[at];
            if (look.slot.load(std::memory_order_acquire) != Slot::full) continue;
            Stack stack(look.stack.begin(), look.stack.begin() + static_cast<std::ptrdiff_t>(look.size));
            for (const Word code : stack) {
                if (codes_.insert(code).second) fresh.push_back(code);
            }
            count({look.native, std::move(stack)});
            look.slot.store(Slot::empty, std::memory_order_release);
        }
        return fresh;
    }

    // Return how often each thread was seen in which functions, the innermost first; in none outside of Python.
    std::vector<std::tuple<Word, Stack, int>> seen() const {
        std::vector<std::tuple<Word, Stack, int>> rows;
        for (const auto& [place, count] : seen_) rows.emplace_back(place.first, place.second, count);
        return rows;
    }

    // Return what each thread took of the processor [s].
    std::vector<std::tuple<Word, double>> taken() const {
        std::vector<std::tuple<Word, double>> rows;
        for (const auto& [native, thread] : threads_) rows.emplace_back(native, thread.last - thread.first);
        return rows;
    }

    int looks() const { return noted_; }

    // What the threads took for their looks [s].
    double cost() const { return 1e-9 * static_cast<double>(cost_.load()); }

private:
    static inline std::atomic<Sampler*> active{nullptr};
    static inline std::atomic<int> looking{0};

    // A thread has run for a period. On that thread, wherever it is: nothing here may wait, or take memory.
    static void signalled(siginfo_t* info) {
        const int error = errno;
        ++looking;
        Sampler* sampler = active.load();
        auto* thread = static_cast<Thread*>(info->si_value.sival_ptr);
        if (sampler != nullptr && info->si_code == SI_TIMER) sampler->look(*thread);
        --looking;
        errno = error;
    }

    bool start_timer(Thread& thread) {
        sigevent event{};
        event.sigev_notify = SIGEV_THREAD_ID;
        event.sigev_signo = SIGPROF;
        event.sigev_value.sival_ptr = &thread;
        event._sigev_un._tid = static_cast<pid_t>(thread.native);
        if (timer_create(clock_of(thread.native), &event, &thread.timer) != 0) return false;
        const double whole = std::floor(period_);
        const timespec each{static_cast<time_t>(whole), static_cast<long>((period_ - whole) * 1e9)};
        const itimerspec every{each, each};
        return timer_settime(thread.timer, 0, &every, nullptr) == 0;
    }

    void look(Thread& thread) {
        const double began = seconds(CLOCK_THREAD_CPUTIME_ID);
        Look& look = looks_[next_.fetch_add(1) % most_looks];
        Slot slot = Slot::empty;
        if (!look.slot.compare_exchange_strong(slot, Slot::written)) return;  // more than are gathered
        look.native = thread.native;
        look.size = stack(thread, look.stack);
        look.slot.store(Slot::full, std::memory_order_release);
        cost_ += static_cast<std::int64_t>((seconds(CLOCK_THREAD_CPUTIME_ID) - began) * 1e9);
    }

    // Fill in the functions that this thread is in, the innermost first; return how many.
    std::size_t stack(const Thread& thread, std::array<Word, depth>& into) const {
        Word frame = current(thread.native);
        std::size_t size = 0;
        for (; frame != 0 && size < depth; ++size) {
            std::array<Word, frame_words> words{};
            if (!read(frame, words.data(), words.size())) break;
            into[size] = words[static_cast<std::size_t>(layout_.code)] & ~tags;
            frame = words[static_cast<std::size_t>(layout_.previous)];
        }
        return size;
    }

    // Return the frame in which a thread is; 0 outside of Python. Its state is looked for each time: a thread that
    // Zenoh calls back on has another one for each call, and what was one looks like it for a while.
    Word current(Word native) const {
        Word state = layout_.oldest;
        for (std::size_t seen = 0; state != 0 && seen < most_threads; ++seen) {
            std::array<Word, state_words> words{};
            if (!read(state, words.data(), words.size())) return 0;
            if (words[static_cast<std::size_t>(layout_.native)] == native) {
                Word frame = words[static_cast<std::size_t>(layout_.current)];
                if (layout_.inner < 0) return frame;
                const Word inner = frame + sizeof(Word) * static_cast<Word>(layout_.inner);
                return frame != 0 && read(inner, &frame, 1) ? frame : 0;
            }
            state = words[static_cast<std::size_t>(layout_.newer)];
        }
        return 0;
    }

    void count(std::pair<Word, Stack> place) {
        ++noted_;
        if (seen_.size() >= most_stacks && !place.second.empty() && !seen_.count(place)) {
            place.second = {place.second.back()};
        }
        ++seen_[std::move(place)];
    }

    Layout layout_;
    double period_;
    std::unique_ptr<Look[]> looks_;
    std::atomic<std::size_t> next_{0};
    std::atomic<std::int64_t> cost_{0};
    std::map<Word, Thread> threads_;
    std::map<std::pair<Word, Stack>, int> seen_;
    std::set<Word> codes_;
    int noted_ = 0;
};

// Return the words from an address on; none where they cannot be read.
Stack words(Word address, std::size_t count) {
    Stack found(count);
    if (!read(address, found.data(), count)) found.clear();
    return found;
}

}  // namespace

NB_MODULE(_native, module) {
    nb::class_<Layout>(module, "Layout")
        .def("__init__",
             [](Layout* self, Word oldest, int newer, int native, int current, int inner, int code, int previous) {
                 new (self) Layout{oldest, newer, native, current, inner, code, previous};
             },
             "oldest"_a, "newer"_a, "native"_a, "current"_a, "inner"_a, "code"_a, "previous"_a);
    const auto alone = nb::call_guard<nb::gil_scoped_release>();
    nb::class_<Sampler>(module, "Sampler")
        .def(nb::init<Layout, double>(), "layout"_a, "period"_a)
        .def("watch", &Sampler::watch, "natives"_a, "fresh"_a, alone)
        .def("stop", &Sampler::stop, alone)
        .def("gather", &Sampler::gather, alone)
        .def("seen", &Sampler::seen)
        .def("taken", &Sampler::taken)
        .def_prop_ro("looks", &Sampler::looks)
        .def_prop_ro("cost", &Sampler::cost);
    module.def("words", &words, "address"_a, "count"_a);
}
