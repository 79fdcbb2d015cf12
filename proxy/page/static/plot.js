// Curves over the last minutes.

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 600, HEIGHT = 100;

export function plot() {
  const svg = document.createElementNS(SPACE, "svg");
  svg.setAttribute("class", "plot");
  svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  return svg;
}

// Each curve is a list of [t, value or null]; `most` is the top of the picture.
export function draw(svg, curves, span, now, least, most) {
  while (svg.children.length < curves.length) svg.append(document.createElementNS(SPACE, "polyline"));
  const height = most - least || 1;
  curves.forEach((curve, place) => {
    const points = curve.points.filter(([, value]) => value !== null && value !== undefined);
    const line = svg.children[place];
    line.setAttribute("class", curve.name);
    line.setAttribute("points", points.map(([t, value]) => {
      const x = WIDTH * (1 - (now - t) / span), y = HEIGHT * (1 - (value - least) / height);
      return `${x.toFixed(1)},${Math.min(HEIGHT - 1, Math.max(1, y)).toFixed(1)}`;
    }).join(" "));
  });
}
