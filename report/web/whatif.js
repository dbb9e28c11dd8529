"use strict";
/* What if: the measured shot thrown again in the page, with other numbers and stones moved by hand. */
class WhatIf {
  constructor(data, scene) {
    this.data = data;
    this.scene = scene;
    this.sliders = [...document.querySelectorAll("#whatif input[type=range]")];
    this.model = byId("whatif-model");
    this.ice = byId("whatif-ice");
    this.curl = byId("whatif-curl");
    this.known = Object.fromEntries(scene.stones.map((stone) => [stone.name, stone]));
    this.#draw();
    this.initial = new Map(this.sliders.map((slider) => [slider.id, slider.value]));
    for (const input of [...this.sliders, this.model, this.ice, this.curl]) {
      input.addEventListener("input", () => this.update());
    }
    byId("whatif-reset").addEventListener("click", () => this.reset());
    byId("whatif-copy").addEventListener("click", () => this.copy());
    byId("whatif-run").addEventListener("click", () => this.animate());
    this.reset();
  }

  #draw() {
    const { data, scene } = this, done = simulator.simulate(data.shot);
    const end = simulator.endOf(done);
    this.unchanged = data.shot.stones.map((_, k) => simulator.stateAt(done, k, end));
    const places = [...data.shot.stones, ...(scene.rings.length ? this.unchanged : [])];
    const seen = scene.rings.length ? [] : player.places; // elsewhere discs may end far away
    this.plan = new PlanView(byId("whatif-view"), scene, places.map(({ x, y }) => [x, y]).concat(seen));
    this.unchanged.forEach(({ x, y }, k) => {
      const ghost = this.plan.stone(this.known[data.shot.stones[k].name], "ghost");
      ghost.move(x, y, 0);
      ghost.turns(false);
    });
    this.drawn = data.shot.stones.map((stone, k) => {
      const known = this.known[stone.name], trail = this.plan.trail(known.colour, "simulated");
      const end = this.plan.stone(known, "end"), start = this.plan.stone(known);
      for (const drawn of [start, end]) drawn.turns(known.turns);
      this.#holdable(start, k);
      return { trail, start, end };
    });
  }

  /** Let a stone be dragged by mouse and finger, and moved by the arrow keys. */
  #holdable(drawn, k) {
    const { group } = drawn, { name } = this.data.shot.stones[k];
    group.setAttribute("tabindex", 0);
    group.setAttribute("role", "button");
    group.setAttribute("data-keys", "");
    group.dataset.held = name;
    let offset = null;
    group.addEventListener("pointerdown", (event) => {
      const [x, y] = this.plan.placeUnder(event.clientX, event.clientY);
      offset = [this.places[k][0] - x, this.places[k][1] - y];
      group.setPointerCapture(event.pointerId);
      event.preventDefault();
      group.focus({ preventScroll: true });
    });
    group.addEventListener("pointermove", (event) => {
      if (!offset) return;
      const [x, y] = this.plan.placeUnder(event.clientX, event.clientY);
      this.place(k, x + offset[0], y + offset[1]);
    });
    for (const end of ["pointerup", "pointercancel"]) group.addEventListener(end, () => { offset = null; });
    group.addEventListener("keydown", (event) => {
      const step = event.shiftKey ? 0.001 : 0.01;
      const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
      if (!way) return;
      event.preventDefault();
      event.stopPropagation();
      this.place(k, this.places[k][0] + way[0] * step, this.places[k][1] + way[1] * step);
    });
  }

  /** Put stone `k` there, or as near as the others leave it room. */
  place(k, x, y) {
    const least = 2 * this.data.shot.radius + 1e-6;
    for (let turn = 0; turn < 8; turn++) {
      const near = this.places.find(([a, b], j) => j !== k && Math.hypot(x - a, y - b) < least);
      if (!near) {
        this.places[k] = [x, y];
        this.update();
        return;
      }
      const dx = x - near[0], dy = y - near[1], apart = Math.hypot(dx, dy) || 1;
      x = near[0] + (dx / apart || 1) * least * 1.0001;
      y = near[1] + (dy / apart) * least * 1.0001;
    }
  }

  reset() {
    const { shot } = this.data;
    this.places = shot.stones.map(({ x, y }) => [x, y]);
    for (const slider of this.sliders) slider.value = this.initial.get(slider.id);
    this.model.value = shot.impact.name;
    this.ice.value = "measured";
    this.curl.value = "measured";
    this.update();
  }

  /** The shot as it now stands. */
  shot() {
    const { data } = this, value = (name) => {
      const slider = byId(`whatif-${name}`);
      // Where it was not moved it stands for the measured number with all its digits.
      return slider.value === this.initial.get(slider.id) ? null : Number(slider.value);
    };
    const law = (family) => {
      const name = this[family].value;
      return name === "measured" ? data.shot[family] : data.laws[family][name];
    };
    const base = {
      ...data.shot,
      stones: data.shot.stones.map((stone, k) => ({ ...stone, x: this.places[k][0], y: this.places[k][1] })),
      impact: { ...data.shot.impact, name: this.model.value },
      ice: law("ice"),
      curl: law("curl"),
    };
    return simulator.changed(base, data.thrown, {
      restitution: value("restitution"),
      stoneFriction: value("rub"),
      friction: value("friction"),
      speed: value("speed"),
      spin: value("spin"),
      aimOffset: (value("aim") ?? 0) / 100,
    });
  }

  /** Simulate and show the outcome. */
  update() {
    for (const slider of this.sliders) {
      const shown = number(Number(slider.value), Number(slider.dataset.decimals));
      byId(`${slider.id}-value`).textContent = `${shown}${slider.dataset.unit}`;
    }
    byId("whatif-rub").disabled = this.model.value !== "frictional";
    const shot = this.shot();
    let done;
    try {
      done = simulator.simulate(shot);
    } catch (error) {
      byId("whatif-said").textContent = `It cannot be simulated: ${error.message}.`;
      return;
    }
    this.done = done;
    this.end = simulator.endOf(done);
    this.rest = shot.stones.map((_, k) => simulator.stateAt(done, k, this.end));
    this.drawn.forEach(({ trail, start, end }, k) => {
      const { x, y, theta = 0 } = shot.stones[k], rest = this.rest[k];
      const moved = Math.hypot(rest.x - x, rest.y - y) > 1e-3;
      start.move(x, y, theta);
      end.show(moved);
      end.move(rest.x, rest.y, rest.theta);
      end.group.classList.toggle("gone", done.gone[k] < Infinity);
      trail.through(moved ? this.#way(k) : []);
      start.group.setAttribute("aria-label",
        `Stone ${shot.stones[k].name} at x ${number(x, 3)}, y ${number(y, 3)} metres. Arrow keys move it.`);
    });
    this.#tell(shot);
  }

  /** Places along the way of stone `k`, its hits among them. */
  #way(k) {
    const places = [], paths = this.done.paths[k];
    paths.forEach((path, rank) => {
      const until = Math.min(path.stop, paths[rank + 1]?.start ?? Infinity, this.done.gone[k]);
      for (let i = 0; i <= 24; i++) {
        const { x, y } = path.at(path.start + ((until - path.start) * i) / 24);
        places.push([x, y]);
      }
    });
    return places;
  }

  #tell(shot) {
    const table = byId("whatif-out");
    table.replaceChildren(...shot.stones.flatMap((stone, k) => {
      const rest = this.rest[k], was = this.unchanged[k];
      const moved = Math.hypot(rest.x - stone.x, rest.y - stone.y) > 1e-3;
      const off = Math.hypot(rest.x - was.x, rest.y - was.y);
      if (!moved && off < 1e-3) return [];
      const row = document.createElement("tr");
      const cells = [stone.name, number(rest.x, 3), number(rest.y, 3),
        this.done.gone[k] < Infinity ? "left" : number(Math.hypot(rest.x, rest.y), 3), number(100 * off, 1)];
      cells.forEach((text, i) => {
        const cell = document.createElement(i ? "td" : "th");
        if (!i) { cell.scope = "row"; cell.style.setProperty("--stone", this.known[stone.name].colour); }
        cell.textContent = text;
        row.append(cell);
      });
      return [row];
    }));
    const hits = this.done.hits.map(({ stones, t }) => `${stones[0]} hits ${stones[1]} after ${number(t, 2)} s`);
    const said = [hits.length ? `${hits.join(", ")}.` : "No stones hit each other."];
    const gone = shot.stones.filter((_, k) => this.done.gone[k] < Infinity).map(({ name }) => name);
    if (gone.length) said.push(`${gone.join(", ")} ${gone.length > 1 ? "leave" : "leaves"} the sheet.`);
    if (this.scene.rings.length) {
      const near = this.rest.map(({ x, y }, k) => (this.done.gone[k] < Infinity ? Infinity : Math.hypot(x, y)));
      const nearest = Math.min(...near);
      const lies = shot.stones[near.indexOf(nearest)].name;
      const inside = nearest < this.scene.rings[0] + shot.radius;
      said.push(inside ? `${lies} lies nearest the tee.` : "No stone lies in the house.");
    }
    byId("whatif-said").textContent = said.join(" ");
  }

  /** Let the stones run from start to end in real time. */
  animate() {
    const begun = performance.now(), mine = (this.run = {}), { done, end } = this;
    const tick = (now) => {
      const t = (now - begun) / 1000;
      if (this.run !== mine || this.done !== done) return;
      this.drawn.forEach((drawn, k) => {
        const s = simulator.stateAt(done, k, Math.min(t, end));
        drawn.start.move(s.x, s.y, s.theta);
      });
      if (t < Math.min(end, 60) + 1) requestAnimationFrame(tick);
      else this.update();
    };
    requestAnimationFrame(tick);
  }

  /** Put the shot on the clipboard as a SHOT.toml for `curlshot simulate`. */
  async copy() {
    const text = shotToml(this.shot());
    const area = byId("whatif-toml");
    area.value = text;
    area.hidden = false;
    area.select();
    try {
      await navigator.clipboard.writeText(text);
    } catch {
      document.execCommand("copy");
    }
  }
}

/** A shot as the SHOT.toml that `curlshot simulate` reads. */
function shotToml(shot) {
  const exact = (value) => (Number.isInteger(value) ? value.toFixed(1) : String(value));
  const { name: model, ...impact } = shot.impact, { name: ice, factor = 1, ...law } = shot.ice;
  const { name: curl, ...turning } = shot.curl;
  if (model !== "frictional") delete impact.stone_friction, delete impact.inertia;
  for (const key of ["friction", "a", "b"]) if (key in law) law[key] *= factor;
  const sheet = shot.bounds ? (shot.bounds.play > 0 ? "up" : "down") : "none";
  const lines = ["[physics]", `sheet = "${sheet}"`, `model = "${model}"`, `ice = "${ice}"`, `curl = "${curl}"`, `radius = ${exact(shot.radius)}`];
  for (const [key, value] of Object.entries({ ...impact, ...law, ...turning })) lines.push(`${key} = ${exact(value)}`);
  for (const stone of shot.stones) {
    lines.push("", "[[stone]]", `name = ${JSON.stringify(stone.name)}`);
    for (const key of ["x", "y", "vx", "vy", "omega", "theta", "mass"]) lines.push(`${key} = ${exact(stone[key])}`);
    if (model === "rigid-body") lines.push(`omega_after = [${stone.omega_after.map(exact).join(", ")}]`);
  }
  return `${lines.join("\n")}\n`;
}

const whatIf = shotData.what_if ? new WhatIf(shotData.what_if, shotData) : null;
