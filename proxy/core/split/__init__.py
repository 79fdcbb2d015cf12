"""A fixed split of the shared limits that follows demand slowly, and holds whatever happens to digests.

Each robot may use a *part* of every shared limit, counted in units of 1/10,000 (`UNIT`). What it sends in any
constraint window uses at most its part, so the union of all robots holds when parts sum to at most the whole.

1. *Bids.* Each robot announces what it asks for: a short list of segments, each an amount and what it is worth
   (`protocol/bid.py`, made of a robot's streams in `demand.py`). A bid has a version, which grows.
2. *Tables.* The bids of all robots that one knows, itself included, are its table (`table.py`). `allocate`
   (`allocation.py`) makes parts out of a table, and all who have the same table compute the same parts. A robot whose
   bid is not known yet has an equal part reserved.
3. *Agreement* (`agreement.py`). Each digest holds a hash of the sender's table. A robot has *agreed* on a table once
   all others whose bids are in it have announced its hash. Robots hear of bids at different times, so their tables
   differ for a moment. Meanwhile a robot's part is the least that any table of its log (`table_log.py`) gives it, from
   the last one agreed on to the newest one. Those that it has not announced are left out: nobody can have agreed on
   them.
4. *Guard time* (`own_part.py`). A part shrinks at once. A part that grows is used one constraint window later, when
   what others sent before they shrank has left the window (`steady.py`). Each announces for how long it has sent
   nothing that its newest table leaves no room for. Where that held for all before they announced the table, the window
   begins then, not with the agreement: sooner by what digests take. What was sent in room that is given up does not
   count against what is kept, for nobody else uses that room before it has left the window (`ledger.py`).
5. *Turns* (`turns.py`). A message larger than its robot's part needs a *slot*: room for it in every window, which
   several robots use one after the other, as in a token ring. Who holds a slot passes it on by announcing a greater
   turn number. The next robot takes it when it hears that, and uses it once the last message in it has left the window.
   Nobody trusts a clock.

`Split` puts this together for one robot: it takes members, digests and sends, and keeps what is ours. `Exchange` knows
what to announce and what to request again.

Why the union holds. Versions only grow, and a robot that loses sight of another raises its own. So no table comes back,
and all robots have their tables in one order, as far as these were agreed on. Take the last table that anybody agreed
on. Everybody had it, and nobody has agreed on a later one, so it is among the tables of which each takes the least: no
part is more than that table gives, and its parts sum to at most the whole. A lost, late or repeated digest can only
delay an agreement; until then, room stays unused.

Two teams that meet have no table in common. Each reserves equal parts for the other as soon as it sees them, so
the union exceeds a limit only until each has seen all of the other, and one window more. One that is back after a
moment may have seen nothing of it, and reserves nothing. So who agreed on a table without it has the kept part of a
newcomer until both agree on one.

A newcomer has agreed on nothing. At first it uses a kept part: the floor divided by `newcomers`. When it has been there
for so long that all must have seen it, it uses the equal part that they leave it. It agrees on its first table when it
knows everybody's bid; or, from then on, on one in which those that it did not hear have equal parts. If it sees nobody
then, everything is its own. A robot that is gone leaves the table at once, and the others' parts grow when they have
agreed on the table without it.

Only robots that take part the same way may be members: the same protocol, limits and floor. Any other would never
announce the same hash. Parts would then stay as they are, and never grow.

A large team asks for nothing, as agreeing would take it a minute: each robot keeps its equal part, which nobody has to
announce. Only who could not send any of its messages in that bids.

Announcements are small and few, for each goes to everybody: in a team of ten two of each robot take the allowance of
ten seconds. So a robot announces its bid, and then the hash of its table once that holds the bids of all. In unicast
these two go with its state, as nobody may miss them: in digests, of which 30 % were lost, ten robots with equal
messages had agreed on nothing after 25 s in one of six flights, nobody sent, and in the mean they reached 41 to 55 %
of a central decider; now 93 to 96. What is lost all the same is requested. A bid that would leave everybody about as
it is, or only pass on slots so that all together gain less than a tenth, is not announced at all (`proposal.py`). Who
passed a slot on announces it again when the next turn should long be over. Nor does a robot bid before it knows how
often its large samples come, or for 1.5 s: of a rhythm so many messages fit in a window as lie before the first that
is out of it. With ten robots of equal messages (*uniform*) the first table is agreed on after 2 to 5 s, and they
reach 95 to 100 % of a central decider at 20 to 300 ms, 88 to 92 at 1 s.

Figures, by simulation. Two robots to a slot use it for 97, 93, 94 and 95 % of the time where news take 0.02, 0.1, 0.3
and 1 windows. A table is agreed on once each robot has told it after it heard the last change. A digest
takes 7 bytes for it, 17 with two slots, 40 with a bid of six segments, which is sent only until all know it.
"""
