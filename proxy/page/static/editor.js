// The specs, to be changed: checked while one types, put in force when one says so.

import { ask, token } from "./ask.js";
import { complain, report } from "./control.js";
import { element, say } from "./words.js";

const PAUSE = 600; // [ms] after the last key
const [choice, text, lines, mistakes, state] = ["file", "text", "lines", "mistakes", "specs-state"].map((id) => document.getElementById(id));
const button = Object.fromEntries(["check", "push", "revert"].map((id) => [id, document.getElementById(id)]));
let files = {}, found = [], inForce = { generation: "", files: {} }, timer = 0, seen = null;

// Follow what is in force, unless there is something unsaved.
export async function follow(generation) {
  if (generation === seen) return;
  seen = generation;
  const changed = edited();
  try {
    inForce = await ask("specs");
  } catch {
    seen = null; // it is asked again with the next status
    return;
  }
  if (!changed && edited()) take(inForce.files);
  tell();
}

function edited() {
  return JSON.stringify(files) !== JSON.stringify(inForce.files);
}

function take(given) {
  const before = choice.value;
  files = { ...given };
  const names = Object.keys(files).sort();
  choice.replaceChildren(...names.map((name) => element("option", name)));
  if (names.includes(before)) choice.value = before;
  document.querySelector(".editor").hidden = !names.length;
  found = [];
  show();
}

function show() {
  text.value = files[choice.value] ?? "";
  number();
  list();
}

function number() {
  const of = (line) => found.filter((each) => each.file === choice.value && each.line === line);
  lines.replaceChildren(...text.value.split("\n").flatMap((_, place) => {
    const here = of(place + 1);
    const kind = here.some((each) => each.wrong) ? "wrong" : here.length ? "odd" : "";
    return [element("span", String(place + 1), kind ? { class: kind } : {}), "\n"];
  }));
  lines.scrollTop = text.scrollTop;
}

function list() {
  mistakes.replaceChildren(...found.map((each) => {
    const item = element("li", "", { class: each.wrong ? "wrong" : "odd" });
    const place = each.line === null ? each.file : `${each.file}:${each.line}`;
    const link = element("a", `${each.wrong ? "" : "warning: "}${place}: ${[each.key, each.message].filter(Boolean).join(": ")}`, { href: "#text" });
    link.addEventListener("click", (event) => { event.preventDefault(); go(each); });
    item.append(link);
    return item;
  }));
  text.setAttribute("aria-invalid", String(found.some((each) => each.wrong)));
}

function go(mistake) {
  if (mistake.file in files && mistake.file !== choice.value) { choice.value = mistake.file; show(); }
  const all = text.value.split("\n"), line = Math.max(1, mistake.line ?? 1);
  const start = all.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
  text.focus();
  text.setSelectionRange(start, start + (all[line - 1] ?? "").length);
  text.scrollTop = (line - 4) * parseFloat(getComputedStyle(text).lineHeight);
}

function heard(report) {
  found = [...report.errors.map((each) => ({ ...each, wrong: true })), ...report.warnings];
  number();
  list();
}

function tell(more = "") {
  const what = Object.keys(inForce.files).length ? `specs ${inForce.generation} are in force` : "no specs are in force";
  say(state, [what, edited() ? "what stands here is not" : "", more].filter(Boolean).join("; "));
}

async function check() {
  if (!token) return;
  try {
    const report = await ask("check", { files });
    heard(report);
    tell(report.fit ? "checked: no mistake" : `checked: ${report.errors.length} mistake${report.errors.length > 1 ? "s" : ""}`);
  } catch (error) {
    tell(error.message);
  }
}

async function push() {
  button.push.disabled = true;
  try {
    const answer = await ask("push", { files });
    heard(answer);
    report(answer.outcomes);
    const refused = answer.outcomes.filter((each) => !each.obeyed).map((each) => each.robot);
    if (answer.fit && !refused.length) inForce.files = { ...files }; // the next status tells their generation
    if (!answer.fit) tell("not put in force: there are mistakes");
    else tell(refused.length ? `not taken by ${refused.join(", ")}` : "put in force on all robots");
  } catch (error) {
    complain(error.message);
    tell(error.message);
  }
  button.push.disabled = !token;
}

text.addEventListener("input", () => {
  files[choice.value] = text.value;
  number();
  tell();
  clearTimeout(timer);
  timer = setTimeout(check, PAUSE);
});
text.addEventListener("scroll", () => { lines.scrollTop = text.scrollTop; });
choice.addEventListener("change", show);
button.check.addEventListener("click", check);
button.push.addEventListener("click", push);
button.revert.addEventListener("click", () => { take(inForce.files); tell(); });
button.check.disabled = button.push.disabled = !token;
text.readOnly = !token;
