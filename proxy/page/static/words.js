// Quantities as text for people.

export function seconds(value) {
  if (value === null || value === undefined) return "–";
  if (value < 0.9995) return `${Math.round(value * 1000)} ms`;
  return `${value < 10 ? value.toFixed(1) : Math.round(value)} s`;
}

export function number(value, digits = 3) {
  if (value === null || value === undefined) return "–";
  if (value === 0) return "0";
  return Math.abs(value) >= 1000 ? String(Math.round(value)) : String(Number(value.toPrecision(digits)));
}

export function rate(value) {
  return value === null || value === undefined ? "–" : `${value.toFixed(1)}/s`;
}

export function amount(value, unit) {
  if (value === null || value === undefined) return "–";
  if (unit !== "B") return `${number(value)} ${unit}`;
  if (value >= 1e6) return `${number(value / 1e6)} MB`;
  return value >= 1e3 ? `${number(value / 1e3)} kB` : `${number(value)} B`;
}

export function element(name, text = "", attributes = {}) {
  const made = document.createElement(name);
  made.textContent = text;
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

// Set a text only where it changed, so that screen readers are not told the same again.
export function say(where, text) {
  if (where.textContent !== text) where.textContent = text;
}
