"""A fixed split of the shared limits that follows demand slowly, and holds whatever happens to digests.

Each robot may use a *part* of every shared limit, counted in units of 1/10,000 (`UNIT`). What it sends in any
constraint window uses at most its part, so the union of all robots holds when parts sum to at most the whole.

1. *Bids.* Each robot announces what it asks for: segments, each an amount and what it is worth (`protocol/bid.py`, made
   of a robot's streams in `demand.py`). A bid has a version, which grows.
2. *Tables.* The bids of all robots that one knows are its table (`table.py`). All who have the same table compute the
   same parts (`allocation.py`); a robot whose bid is not known has an equal part.
3. *Agreement* (`agreement.py`). Each digest holds a hash of the sender's table. A robot has *agreed* on a table once
   all others whose bids are in it have announced its hash. Meanwhile its part is the least that any table of its log
   (`table.py`) gives it, from the last one agreed on to the newest that it has announced.
4. *Guard time* (`own_part.py`). A part shrinks at once. It grows one constraint window later, when what others sent
   before they shrank has left the window. What was sent in room that is given up does not count against what is kept.
5. *Turns* (`turns.py`). A message larger than its robot's part needs a *slot*: room for it in every window, which
   several robots use one after the other, as in a token ring. Who holds it passes it on by announcing a greater turn
   number; the next one uses it once the last message in it has left the window. Nobody trusts a clock.

`Split` puts this together for one robot; `Exchange` knows what to announce and what to request again.

Why the union holds. Versions only grow, and a robot that loses sight of another raises its own. So no table comes back,
and all robots have their tables in one order, as far as these were agreed on. Take the last table that anybody agreed
on. Everybody had it, and nobody has agreed on a later one, so it is among the tables of which each takes the least: no
part is more than that table gives, and its parts sum to at most the whole. A lost, late or repeated digest can only
delay an agreement; until then, room stays unused. That is so where an operator configures a split; where a team
changes over by itself a robot may use more than its part, as few use theirs at once (`coordination/overbooking.py`).

Two teams that meet reserve equal parts for each other, so the union exceeds a limit only until each has seen all of the
other, and one window more. One that is back after a moment reserves nothing: who agreed on a table without it has the
kept part of a newcomer until both agree on one. A newcomer uses the floor divided by `newcomers`, then, when all must
have seen it, the equal part that they leave it. A robot that is gone leaves the table at once. Only robots of the same
protocol, limits and floor may be members: any other would never announce the same hash.

Announcements are few, for each goes to everybody: a robot announces its bid, and then the hash of its table once that
holds the bids of all; in unicast with its state, as in digests, of which 30 % were lost, ten robots reached 41 to 55 %
of a central decider, and 93 to 96 so. A bid that gains all together less than a tenth is not announced,
nor one that gains less than it costs that slots rest until all agree.
Ten robots of equal messages agree first after 2 to 5 s, and reach 95 to 100 % of a central decider at 20 to 300 ms, 88
to 92 at 1 s. Two robots to a slot use it for 97, 93, 94 and 95 % of the time where news take 0.02, 0.1, 0.3 and 1
windows.
"""
