// Per robot and type: what was generated, forwarded and dropped, and why.

import { ask } from "./ask.js";
import { element, number, rate, say, seconds } from "./words.js";

const body = document.getElementById("fleet");
const rows = new Map();
const HEADS = {
  robot: "", type: "type", mode: "mode", made: "generated", sent: "forwarded", unsent: "dropped", why: "why", age: "age",
  worth: "utility",
};

export function tell(robots) {
  const wanted = new Map();
  for (const robot of robots) {
    const types = robot.types.length ? robot.types : [null];
    for (const type of types) wanted.set(`${robot.zid} ${type?.type ?? ""}`, [robot, type]);
  }
  for (const [name, row] of rows) if (!wanted.has(name)) { row.line.remove(); rows.delete(name); }
  for (const [name, [robot, type]] of wanted) {
    const row = rows.get(name) ?? made(name);
    fill(row, robot, type);
    const place = [...wanted.keys()].indexOf(name);
    if (body.children[place] !== row.line) body.insertBefore(row.line, body.children[place] ?? null);
  }
}

function made(name) {
  const line = element("tr", "", { role: "row" });
  const cells = {};
  for (const each of Object.keys(HEADS)) {
    cells[each] = element(each === "robot" ? "th" : "td", "", { role: each === "robot" ? "rowheader" : "cell", "data-head": HEADS[each] });
    if (["made", "sent", "unsent", "age", "worth"].includes(each)) cells[each].className = "number";
    line.append(cells[each]);
  }
  cells.robot.scope = "row";
  cells.why.className = "reasons";
  const reasons = element("span");
  const button = element("button", "why …", { type: "button" });
  cells.why.append(reasons, " ", button);
  const row = { line, cells, reasons, button, robot: null, type: null };
  button.addEventListener("click", () => explain(row));
  rows.set(name, row);
  return row;
}

function fill(row, robot, type) {
  row.robot = robot;
  row.type = type;
  const { cells } = row;
  say(cells.robot, robot.robot);
  cells.robot.title = robot.itself ? "by what it says itself" : `as robot ${robot.seen_by} sees it`;
  say(cells.type, type ? type.type : "publishes nothing");
  say(cells.mode, robot.takes_part ? robot.mode ?? "–" : "takes no part");
  twice(cells.made, type?.made, type?.generated);
  twice(cells.sent, type?.sent, type?.forwarded);
  twice(cells.unsent, type?.unsent, type ? type.generated - type.forwarded : null);
  say(row.reasons, reasons(type));
  row.button.hidden = !type?.why_known;
  row.button.setAttribute("aria-label", `why: the last decisions on ${type?.type} of ${robot.robot}`);
  say(cells.age, type ? seconds(type.age) : "–");
  say(cells.worth, type?.worth ? `${number(type.worth.now)} of ${number(type.worth.most)}` : "–");
  for (const cell of Object.values(cells)) cell.classList.toggle("nothing", row.button.hidden && cell.textContent.startsWith("–"));
}

function twice(cell, each, all) {
  const text = rate(each), total = all === null || all === undefined ? "" : `${all} in all`;
  if (!cell.firstChild) cell.append("", element("small"));
  if (cell.firstChild.data !== text) cell.firstChild.data = text;
  say(cell.lastChild, total);
}

function reasons(type) {
  if (!type) return "–";
  if (!type.why_known) return type.generated > type.forwarded ? "only its own daemon knows (--connect)" : "–";
  return type.why.map((each) => `${each.words} (${rate(each.rate)})`).join("; ") || "nothing is dropped";
}

async function explain(row) {
  const dialog = document.getElementById("why");
  say(document.getElementById("why-title"), `Why: ${row.type.type} of ${row.robot.robot}`);
  const text = document.getElementById("why-text");
  say(text, "asking …");
  dialog.showModal();
  const found = [];
  for (const key of row.type.keys.slice(0, 4)) {
    try {
      const where = new URLSearchParams({ robot: row.robot.called, key });
      found.push((await ask(`why?${where}`)).text);
    } catch (error) {
      found.push(error.message);
    }
  }
  say(text, found.join("\n\n"));
}
