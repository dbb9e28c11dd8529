"use strict";
/* The sheet from above as SVG: rings, lines, trails, stones. Places come in metres, x to the right,
   y up; the drawing's unit makes every stone 14.55 units in radius (1 cm for a curling stone). */
const UNITS = 14.55;

function svgElement(name, attributes = {}, parent = null) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  parent?.append(element);
  return element;
}

class PlanView {
  /** An empty sheet in `svg`, wide enough for all of `places` and the house. */
  constructor(svg, { radius, rings, lines, stones }, places) {
    Object.assign(this, { svg, radius, scale: UNITS / radius });
    const margin = (stones.some(({ name }) => name.length > 2) ? 2.8 : 1.8) * radius; // for names
    const [x0, y0, x1, y1] = extent(places, rings, radius, margin).map((value) => value * this.scale);
    svg.setAttribute("viewBox", [x0, -y1, x1 - x0, y1 - y0].map((v) => v.toFixed(1)).join(" "));
    svg.style.aspectRatio = `${(x1 - x0).toFixed(1)} / ${(y1 - y0).toFixed(1)}`;
    const ice = svgElement("g", { class: "ice" }, svg);
    svgElement("rect", { class: "sheet", x: x0, y: -y1, width: x1 - x0, height: y1 - y0 }, ice);
    rings.forEach((r, k) => svgElement("circle", { class: `ring ring-${k}`, r: r * this.scale }, ice));
    if (rings.length) this.#paint(ice, lines, x0, y0, x1, y1);
    this.trails = svgElement("g", { class: "trails" }, svg);
    this.marks = svgElement("g", { class: "marks" }, svg);
    this.stones = svgElement("g", { class: "stones" }, svg);
  }

  #paint(ice, lines, x0, y0, x1, y1) {
    const line = (a, b, c, d) => svgElement("line", { class: "line", x1: a, y1: -b, x2: c, y2: -d }, ice);
    const s = this.scale;
    for (const y of [0, lines.play * lines.back_line, -lines.play * lines.hog_line]) line(x0, y * s, x1, y * s);
    line(0, y0, 0, y1);
  }

  /** Unit coordinates of a place. */
  at(x, y) {
    return [x * this.scale, -y * this.scale];
  }

  /** Place in metres under a point of the window. */
  placeUnder(clientX, clientY) {
    const p = new DOMPoint(clientX, clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return [p.x / this.scale, -p.y / this.scale];
  }

  /** A line through places, in a stone's colour. */
  trail(colour, kind) {
    const line = svgElement("polyline", { class: `trail ${kind}`, stroke: colour }, this.trails);
    const view = this;
    return {
      element: line,
      through(places) {
        const points = places.map(([x, y]) => view.at(x, y).map((v) => v.toFixed(1)).join());
        line.setAttribute("points", points.join(" "));
      },
    };
  }

  /** A stone with its handle; `kind` is solid, ghost or end. A solid one shows its team's colour. */
  stone({ name, colour, team }, kind = "solid") {
    const group = svgElement("g", { class: `stone ${kind}`, style: `--stone: ${colour}` }, this.stones);
    const turned = svgElement("g", {}, group);
    svgElement("line", { class: "handle", x1: UNITS, x2: UNITS * 1.45 }, turned);
    svgElement("circle", { class: "body", r: UNITS }, group);
    if (kind === "solid") {
      if (team) svgElement("circle", { class: "team", r: 0.84 * UNITS, stroke: team }, group);
      const short = name.length <= 2;
      const label = svgElement("text", { class: "name", y: short ? 0 : 1.75 * UNITS }, group);
      label.classList.toggle("outside", !short);
      label.textContent = name.length > 14 ? `${name.slice(0, 13)}…` : name;
    }
    const view = this;
    return {
      group,
      move(x, y, theta) {
        group.setAttribute("transform", `translate(${view.at(x, y).map((v) => v.toFixed(2)).join()})`);
        turned.setAttribute("transform", `rotate(${((-theta * 180) / Math.PI).toFixed(1)})`);
      },
      show(visible) {
        group.style.display = visible ? "" : "none";
      },
      turns(known) {
        turned.style.display = known ? "" : "none";
      },
    };
  }

  /** Where two stones touched: a cross that stays and a ring that flashes. */
  hit(x, y) {
    const [cx, cy] = this.at(x, y), d = 0.35 * UNITS;
    const group = svgElement("g", { class: "hit", transform: `translate(${cx},${cy})` }, this.marks);
    svgElement("path", { class: "cross", d: `M${-d} ${-d}L${d} ${d}M${-d} ${d}L${d} ${-d}` }, group);
    const flash = svgElement("circle", { class: "flash", r: 0 }, group);
    const LASTS = 0.5; // s
    return {
      at(since) {
        group.style.display = since >= 0 ? "" : "none";
        const share = since / LASTS;
        const on = share >= 0 && share < 1;
        flash.setAttribute("r", on ? (0.4 + 2.2 * share) * UNITS : 0);
        flash.style.opacity = on ? 1 - share : 0;
      },
    };
  }
}

/** Corners of what is shown, m: the house and what happens about it, no longer than is of use. */
function extent(places, rings, radius, margin) {
  const rim = rings.length ? rings[0] + 2 * radius : 0;
  const boxes = rings.length ? [[-rim, -rim], [rim, rim]] : [];
  const reach = rings.length ? 6 * rings[0] : Infinity;
  const all = boxes.concat(places.filter(([x, y]) => Math.hypot(x, y) < reach));
  if (!all.length) return [-1, -1, 1, 1];
  const [x0, y0, x1, y1] = boxOf(all);
  const grow = (low, high) => Math.max(margin, (8 * radius - (high - low)) / 2);
  const [dx, dy] = [grow(x0, x1), grow(y0, y1)];
  return [x0 - dx, y0 - dy, x1 + dx, y1 + dy];
}

/** Corners of the box that places fill, m. */
function boxOf(places) {
  let [x0, y0, x1, y1] = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of places) {
    x0 = Math.min(x0, x); x1 = Math.max(x1, x);
    y0 = Math.min(y0, y); y1 = Math.max(y1, y);
  }
  return [x0, y0, x1, y1];
}

/** Places brought into the box that others fill and an edge around it, m. */
function near(others, edge, places) {
  const [x0, y0, x1, y1] = boxOf(others);
  const between = (low, value, high) => Math.min(Math.max(value, low - edge), high + edge);
  return places.map(([x, y]) => [between(x0, x, x1), between(y0, y, y1)]);
}
