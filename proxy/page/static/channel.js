// How full the channel is and what room costs, and what all that is there is worth.

import { draw, plot } from "./plot.js";
import { amount, element, number, say, seconds } from "./words.js";

const SPAN = 300, LEAST = 30; // [s] so much of the past is shown, as far as it is known
const limits = document.getElementById("limits");
const utility = document.getElementById("utility");
const shown = new Map();
let past = [], span = LEAST;
let chart = null;

export function remember(points) {
  past = [...points];
}

export function tell(status) {
  past.push(status.point);
  const now = status.point.t;
  past = past.filter((point) => now - point.t <= SPAN);
  span = Math.max(LEAST, now - past[0].t);
  const names = status.limits.map((limit) => limit.constraint);
  for (const [name, each] of shown) if (!names.includes(name)) { each.box.remove(); shown.delete(name); }
  for (const limit of status.limits) bar(limit, now);
  if (!status.limits.length) say(limits, "no limit is known");
  worth(status.worth, now);
}

function bar(limit, now) {
  const name = limit.constraint;
  if (!shown.has(name)) {
    if (!shown.size) limits.textContent = "";
    const box = element("div", "", { class: "limit" });
    const each = { box, text: element("p"), meter: element("meter", "", { min: 0, max: 1, high: 0.95, optimum: 0, "aria-label": `use of ${name}` }), svg: plot() };
    box.append(each.text, each.meter, each.svg);
    limits.append(box);
    shown.set(name, each);
  }
  const { text, meter, svg } = shown.get(name);
  const used = limit.used_by_all, whole = limit.limit;
  const share = used !== null && whole ? used / whole : 0;
  meter.value = Math.min(1, share);
  const price = limit.price_per_kb === null ? "what 1 kB costs is not known" : `1 kB costs ${number(limit.price_per_kb)}`;
  const over = share > 1 ? " (over it)" : "";
  say(text, `${name}: ${Math.round(100 * share)} %${over} of ${amount(whole, limit.unit)} in ${seconds(limit.window)} used by all; ${price}`);
  const of = (point) => point.limits[name];
  draw(svg, [{ name: "use", points: past.map((p) => [p.t, of(p) ? of(p)[0] / of(p)[1] : null]) }], span, now, 0, 1.05);
  svg.setAttribute("aria-label", `use of ${name} in the last ${seconds(span)}, now ${Math.round(100 * share)} %`);
}

function worth(sum, now) {
  if (!chart) {
    chart = { svg: plot(), text: element("figcaption") };
    utility.append(chart.text, chart.svg);
  }
  const values = past.flatMap((p) => (p.worth ? [p.worth.now, p.worth.most] : []));
  const words = sum
    ? `utility now ${number(sum.now)}, of ${number(sum.most)} had everything arrived at once (dashed); the best that fits the channel is not known while it runs`
    : "utility: not known (no spec of a type of which the newest sample counts, or nobody wants it)";
  say(chart.text, words);
  chart.svg.setAttribute("aria-label", `utility in the last ${seconds(span)}, now ${sum ? number(sum.now) : "unknown"}`);
  const curve = (name, field) => ({ name, points: past.map((p) => [p.t, p.worth ? p.worth[field] : null]) });
  draw(chart.svg, [curve("bound", "most"), curve("now", "now")], span, now, Math.min(0, ...values), 1.05 * Math.max(1e-9, ...values));
}
