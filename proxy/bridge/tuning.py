"""The constants of the bridge, each with why it is what it is; how much is taken in of others stands in `bounds.py`."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class BridgeTuning:
    """Sizes of buffers and pieces, how long is waited for what, and how often it is looked."""

    # The mesh session
    socket_buffer: int = 65536
    """Socket buffers on the mesh [B]. Large ones hide seconds of queue from the daemon."""
    batch: int = 21_000
    """Largest piece on the mesh [B]. Zenoh's 64 kB takes a slow radio longer than a robot may be silent. Two hold a
    sample of 40 kB: in three pieces of 16 kB these crossed at 62 % of a router's rate, in two they do at 72. Urgent
    small ones beside them take as long, as the kernel's buffers hold more than a piece."""
    pieces_waiting: int = 8
    """Pieces that wait in each of Zenoh's queues for samples, on the mesh and for an app. Of bursts of 5,000 samples of
    1 kB that nobody has to wait for an app's link lost 2 % with Zenoh's two pieces of 64 kB, nothing with eight."""
    largest_message: int = 64 * 1024 * 1024
    """Zenoh puts no larger message together on the mesh [B], before anybody looks at what it is: with its own 1 GiB one
    message of a stranger took a robot's memory. A larger sample stays on its robot, and is counted."""
    around_payload: int = 131_072
    """What a message may have beside its payload: a key, an encoding, an attachment [B]."""
    full_link_wait: int = 1000
    """A publication waits this long for a full link before its sample is dropped there [µs]."""
    full_link_wait_pieces: int = 50_000
    """The same for the next of many pieces of a sample, as long as routers wait [µs]."""
    full_link_closes: int = 5_000_000
    """A link that takes this long for a publication that must not be dropped is given up [µs], as long as routers wait:
    with 2 s a sample of 1 MB ended each link of 3 Mbit/s, and was lost."""
    threads_sending: int = 1
    """Zenoh's threads that send, for both sides together: a second one is only woken beside the first."""
    threads_receiving: int = 12
    """Those that receive. Whoever publishes with BLOCK to an app that hangs keeps two of them for as long as Zenoh puts
    up with that app: with so many, five robots that do leave some to the other apps. They share no runtime with those
    below, which wait on all sockets: an idle daemon would take less, but two such apps held up all others for 4 s."""
    threads_linking: int = 2
    """Those that open and end links."""

    # Links
    lease: int = 10_000
    """A link from which Zenoh reads nothing for this long is given up [ms]: a process hangs at its other end. Who
    vanishes is missed sooner, by `silence`."""
    lease_inside: int = 3_600_000
    """The lease of a mirror session's link, which is within the process [ms]."""
    lease_unseen: int = 2000
    """The lease where links may not be TCP, so that the kernel does not know who is silent [ms]."""
    silent_robot: float = 2.0
    """A robot whose kernel says nothing for this long, although it should, is gone [s]."""
    probing: float = 0.25
    """The kernel probes idle links as often as this part of that time, but once a second at most."""
    redial_router: tuple[int, int] = (100, 200)
    """A router that apps use is dialled again after the first of these times, in the end after the other one [ms]."""
    redial_mesh: tuple[int, int] = (200, 1000)
    """The same for what is dialled on the mesh [ms]."""
    redial_slower: float = 1.5
    """Each time takes so many times as long as the one before, until then."""
    link_grace: float = 2.0
    """A link may take this long before it is missed [s]."""
    missing_check: float = 0.5
    """Time between two looks whether endpoints to dial are linked [s]."""
    linked_check: float = 2.0
    """The same as long as all robots are that can be meant [s]: Zenoh has to list all links for it."""
    young_link: float = 1.0
    """A link that ends sooner may be one of two that were dialled at once [s]."""
    rediscovery_interval: float = 0.5
    """Time between two questions of a robot without any link [s]; with each link that is left it is as much longer, for
    all who hear a question answer it."""
    rediscovery_time: float = 60.0
    """A lost robot is looked for for so long [s]; after that Zenoh's own questions have to do."""
    lookout_interval: float = 10.0
    """Time between two looks for what others can reach beside the daemon [s]; one takes a millisecond of a core."""
    lookout_listen: float = 0.3
    """Answers are waited for for so long [s]; on this host they take milliseconds."""

    # The group on which robots broadcast
    join_interval: int = 1000
    """A robot says this often that it is on the group [ms]: a newcomer is heard this late at most. Costs 135 B/s."""
    group_check: float = 0.1
    """Time between two looks at who is heard, and whether anybody can be [s]."""
    group_silent: float = 2.5
    """The session is opened anew when nobody is heard for so long although there are others [s]; then after twice as
    long, and so on."""
    group_buffer: int = 4 * 1024 * 1024
    """What may wait to be read there [B], as far as `net.core.rmem_max` allows. In the kernel's 208 kB one sample of
    1 MB in three was lost where the channel is faster than Zenoh reads."""
    group_unread: int = 10
    """Zenoh reads within milliseconds: it hears nothing more when so many looks find nothing read of what came."""
    longest_group_silent: float = 60.0
    """Nobody is waited for any longer than this before the session is opened anew [s]."""

    # Following what is declared
    mirroring_interval: float = 0.1
    """Time between two reports of what passed, as long as something does, and of what links have waiting, where a limit
    follows that [s]."""
    link_check: float = 0.5
    """Time between two looks at the links [s]. Four times a second they took a fifth of what an idle daemon takes."""
    links_listed: float = 5.0
    """Links are listed this often although nobody told of news [s]."""
    long_look: float = 0.01
    """After a look at the links that took longer than this there is a rest [s]."""
    rest_after_look: float = 3.0
    """The rest takes so many times as long as the look."""
    longest_rest: float = 0.25
    """The rest takes no longer than this [s]."""
    router_forgotten: float = 0.5
    """A router whose link ended is forgotten by Zenoh this soon, with all that was behind it [s]."""
    gone_looked_for: float = 10.0
    """Time between two looks for what was behind it [s]; one takes a tenth of a second for 1,000 subscriptions."""
    grace: float = 0.1
    """What may be replaced by something new stays for so long: longer than a callback of Zenoh's waits to run [s]."""

    # Samples that must not overtake what was declared before them
    quiet_key: float = 1.5
    """A sample of a key of which none came for so long is none of a stream [s]. To hold one takes 0.7 ms of a core."""
    barrier_wait: float = 0.25
    """It waits no longer than this until what was declared before it is mirrored [s]. That takes 2 ms, and took less
    than 0.1 s for 95 of 100 with thirty processes that wanted the two cores."""
    barrier_rest: float = 5.0
    """Where that was too short, no sample waits for so long [s]: the daemon has too much to mirror..."""
    longest_barrier_rest: float = 600.0
    """... and for twice as long each time, up to this, where it always is: access control may not let markers pass."""

    # Samples on their way to the mesh
    stamp_mismatch: float = 1.0
    """A timestamp further than this from the arrival says nothing about when the sample was made [s]."""
    small_sample: int = 32_768
    """A sample of less than this is copied where it is held for longer [B]: as it came it holds a whole piece of
    Zenoh's of 64 kB. Beside images 8,192 samples of 60 B took 400 MB, for which systemd ends the daemon..."""
    few_held: int = 64
    """... where it waits, only as one of more than so many: nearly all go at once."""
    passing_backlog: int = 32
    """With more passing samples, and as many more again, whoever brings one lets the thread catch up."""
    catch_up: float = 0.001
    """Whoever brings a sample lets others leave for this long at most, for each 64 kB of it [s]."""
    push_back: float = 0.05
    """Passing traffic delays a decided sample by no more than this [s]."""
    moving: float = 0.5
    """Full links move when a sample was sent so recently, for each 64 kB of the one in hand [s]: who publishes faster
    is slowed down then, not dropped."""
    reply_waits: float = 5.0
    """A reply waits this long for room, as long as at a router [s]. With 0.5 s an application that takes 0.4 ms for
    each got 14,000 of 20,000 replies of 1 kB."""
    slowed: int = 6
    """So many publishers at a time are slowed down by as much as it takes. Each keeps one of Zenoh's threads meanwhile,
    and half of these are left to the apps."""
    idle_check: float = 0.005
    """Time between two looks whether links are idle, while something waits for its pace [s]; Zenoh's thread has this
    long to write the sample before."""
    quick_sample: float = 0.01
    """What takes no longer than this at the pace [s] goes before what takes longer. A frame of 26 kB at 1 Mbit/s holds
    its successor up for 0.2 s; behind it odometry of 116 B came 172 ms late (nine of ten samples less than that)."""
    made_up: float = 0.01
    """A decided sample may go this much earlier than the pace says, as the one before was late by that [s]: a thread
    that is to wake for each of 2,500 samples a second sent 1,400, and 4,000 waited for three seconds."""
    slow_link_wait: float = 0.25
    """The other links wait for a full one for this long at most [s]."""
    slow_link_rest: float = 5.0
    """Nothing waits again for links that let that time run out for so long [s]."""
    full_link_check: float = 0.002
    """Time between two looks at full links [s]."""
    free_link_check: float = 0.0002
    """Time between two looks at links that have room [s]: their threads have only to be scheduled."""

    # Send buffers
    usable_buffer: float = 0.5
    """Part of a send buffer that is filled without asking again."""
    little_room: int = 16384
    """With less room than this a link counts as slow [B]."""
    idle_buffer: int = 4096
    """A link with no more than this in its socket is idle: something small may always be on its way [B]."""
    sample_overhead: int = 2048
    """What a small sample may take of a send buffer beside its bytes, in the worst case [B]."""
    sent_lately: int = 300
    """A link that sent nothing for so long says nothing of the channel [ms]."""
    dense_segments: int = 4
    """With fewer segments on their way a round trip is longer than the way: receivers wait before they acknowledge."""

    # Samples that come from the mesh
    hold_back: float = 2.0
    """A robot is waited for so long after its return, its last word or its last copy [s]."""
    longest_hold_back: float = 10.0
    """No sample is held back for longer [s]."""

    # The daemon
    name_wait: float = 0.15
    """A daemon that starts listens for this long for another one of its name [s]."""
    order_wait: float = 5.0
    """The other robots have this long to answer an order [s]."""


TUNING = BridgeTuning()
