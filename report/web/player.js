"use strict";
/* The shot played: the clip, the plan view and the speeds, all at one time. The clip's clock
   leads where there is a clip; without one the page's own does. */

/** Running sums of differences, in whole steps of `step`. */
function decode(differences, step = 1) {
  const values = new Float64Array(differences.length);
  let sum = 0;
  differences.forEach((d, k) => { sum += d; values[k] = sum * step; });
  return values;
}

/** Columns of one stone as the page holds them, with the times of its rows. */
function decodeStone(stone, data, times) {
  const at = decode(stone.at), out = { ...stone, rank: at, t: Array.from(at, (k) => times[k]) };
  for (const name of ["x", "y", "theta", "omega", "speed"]) {
    out[name] = decode(stone[name], data.steps[name]);
  }
  return out;
}

/** Places of stones, [x, y] of each row, m. */
function placesOf(stones) {
  return stones.flatMap(({ x, y }) => Array.from(x, (value, k) => [value, y[k]]));
}

/** Index of the last of the rising values that is at most `value`, -1 before the first. */
function lastUpTo(values, value) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

const most = (values) => values.reduce((high, value) => Math.max(high, value), 0);
const moves = (stone) => most(stone.speed) >= 0.05; // m/s
const number = (value, decimals) => value.toFixed(decimals).replace(/^-(?=0\.?0*$)/, "").replace("-", "−");
const byId = (id) => document.getElementById(id);

class Player {
  constructor(data) {
    this.data = data;
    this.times = decode(data.t, data.steps.t);
    this.frames = decode(data.frame);
    this.stones = data.stones.map((stone) => decodeStone(stone, data, this.times));
    this.simulations = Object.fromEntries(
      Object.entries(data.simulations).map(([model, stones]) => [
        model, stones.map((stone) => decodeStone(stone, data, this.times)),
      ]),
    );
    this.rank = 0;
    this.rate = 1;
    this.playing = false;
    this.video = byId("clip");
    this.#drawPlan();
    this.chart = new SpeedChart(byId("speeds"), this);
    this.#listen();
    this.#openClip();
    this.choose(byId("model")?.value ?? "");
    this.show(0);
  }

  #drawPlan() {
    const { data } = this, measured = placesOf(this.stones);
    const simulated = Object.values(this.simulations).flatMap(placesOf);
    // A diverged simulation may leave the plan.
    const places = (this.places = measured.concat(near(measured, 4 * data.radius, simulated)));
    this.plan = new PlanView(byId("plan-view"), data, places);
    this.hits = data.hits.filter((hit) => hit.x !== null).map((hit) => (
      { t: hit.t, mark: this.plan.hit(hit.x, hit.y) }
    ));
    this.ghosts = new Map(this.stones.map((stone) => [
      stone.name, [this.plan.trail(stone.colour, "ghost"), this.plan.stone(stone, "ghost")],
    ]));
    this.drawn = this.stones.map((stone) => {
      const whole = this.plan.trail(stone.colour, "whole"), past = this.plan.trail(stone.colour, "past");
      const places = Array.from(stone.x, (x, k) => [x, stone.y[k]]);
      if (moves(stone)) whole.through(places);
      const drawn = this.plan.stone(stone);
      drawn.turns(stone.turns);
      return { stone, past, places: moves(stone) ? places : null, drawn };
    });
  }

  #openClip() {
    const { video } = this;
    if (!video) return;
    video.controls = false;
    video.addEventListener("error", () => this.#loseClip());
    video.addEventListener("ended", () => this.pause());
    video.addEventListener("click", () => this.toggle());
    if (video.error) this.#loseClip();
  }

  #loseClip() {
    this.video = null;
    byId("player").classList.add("alone");
    byId("clip-missing").hidden = false;
  }

  #listen() {
    const on = (id, event, act) => byId(id)?.addEventListener(event, act);
    on("play", "click", () => this.toggle());
    on("back", "click", () => this.step(-1));
    on("ahead", "click", () => this.step(1));
    on("scrub", "input", (event) => { this.pause(); this.show(Number(event.target.value)); });
    on("rate", "change", (event) => this.setRate(Number(event.target.value)));
    on("model", "change", (event) => this.choose(event.target.value));
    document.addEventListener("keydown", (event) => this.#press(event));
    byId("scrub").max = this.times.length - 1;
  }

  #press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const held = event.target.closest("input, select, textarea, button, a, [data-keys]");
    const free = !held || held.id === "scrub";
    const acts = {};
    if (free || !held.matches("select, textarea")) {
      Object.assign(acts, { ",": () => this.step(-1), ".": () => this.step(1) });
    }
    if (free || held.matches("button, a")) {
      Object.assign(acts, {
        ArrowLeft: () => this.skip(-0.5),
        ArrowRight: () => this.skip(0.5),
        Home: () => this.seek(0),
        End: () => this.seek(this.times.length - 1),
      });
    }
    if (free) acts[" "] = () => this.toggle();
    if (!(event.key in acts)) return;
    event.preventDefault();
    acts[event.key]();
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  play() {
    if (this.playing || this.times.length < 2) return;
    if (this.rank >= this.times.length - 1) this.show(0);
    this.playing = true;
    this.#button();
    if (this.video) {
      this.video.playbackRate = this.rate;
      this.video.play().catch(() => this.pause());
    }
    const started = performance.now(), from = this.times[this.rank];
    const follow = (t) => {
      if (!this.playing) return;
      this.draw(Math.max(lastUpTo(this.times, t + 1e-3), 0));
      if (this.rank >= this.times.length - 1 && !this.video) this.pause();
      else next();
    };
    const next = () => {
      const { video } = this;
      // The time of the very picture that is shown, where the browser tells it.
      if (video?.requestVideoFrameCallback) {
        video.requestVideoFrameCallback((_, { mediaTime }) => follow(mediaTime + this.data.clip_start));
      } else if (video) {
        requestAnimationFrame(() => follow(video.currentTime + this.data.clip_start));
      } else {
        requestAnimationFrame((now) => follow(from + (Math.max(now - started, 0) / 1000) * this.rate));
      }
    };
    next();
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    this.video?.pause();
    this.#button();
  }

  #button() {
    const button = byId("play");
    button.setAttribute("aria-label", this.playing ? "Pause" : "Play");
    button.classList.toggle("on", this.playing);
  }

  setRate(rate) {
    const { playing } = this;
    this.pause();
    this.rate = rate;
    if (playing) this.play();
  }

  step(by) {
    this.seek(this.rank + by);
  }

  skip(seconds) {
    const t = this.times[this.rank] + seconds;
    this.seek(Math.max(lastUpTo(this.times, t + 1e-6), 0));
  }

  seek(rank) {
    this.pause();
    this.show(Math.min(Math.max(rank, 0), this.times.length - 1));
  }

  /** Show a frame everywhere. */
  show(rank) {
    if (this.video) {
      // Into the middle of the frame: its edges may round to the one before.
      const t = this.times[rank], next = this.times[rank + 1] ?? t + 0.01;
      const middle = t + Math.min(next - t, 0.04) / 2;
      this.video.currentTime = Math.max(middle - this.data.clip_start, 0);
    }
    this.draw(rank);
  }

  /** Draw a frame everywhere but in the clip. */
  draw(rank) {
    this.rank = rank;
    const t = this.times[rank];
    for (const { stone, past, places, drawn } of this.drawn) {
      const row = lastUpTo(stone.rank, rank), seen = row >= 0;
      drawn.show(seen);
      if (!seen) continue;
      drawn.move(stone.x[row], stone.y[row], stone.theta[row]);
      if (places) past.through(places.slice(0, row + 1));
    }
    for (const stone of this.simulations[this.model] ?? []) {
      const [, ghost] = this.ghosts.get(stone.name), row = lastUpTo(stone.rank, rank);
      ghost.show(row >= 0 && stone.x.length > 1 && !this.#hides(stone, row, rank));
      if (row >= 0) ghost.move(stone.x[row], stone.y[row], stone.theta[row]);
    }
    for (const hit of this.hits) hit.mark.at(t - hit.t);
    this.#tell(rank, t);
  }

  /** Whether a simulated stone lies so close to the measured one that its rim would only fray it. */
  #hides(simulated, row, rank) {
    const stone = this.stones.find(({ name }) => name === simulated.name), k = lastUpTo(stone.rank, rank);
    if (k < 0) return false;
    return Math.hypot(stone.x[k] - simulated.x[row], stone.y[k] - simulated.y[row]) < 0.1 * this.data.radius;
  }

  #tell(rank, t) {
    const scrub = byId("scrub");
    scrub.value = rank;
    scrub.setAttribute("aria-valuetext", `${number(t, 2)} seconds, frame ${this.frames[rank]}`);
    byId("now").textContent = `${number(t, 2)} s`;
    byId("frame").textContent = `frame ${this.frames[rank]}`;
    this.chart.mark(t);
    for (const cells of document.querySelectorAll("[data-stone]")) {
      const stone = this.stones[Number(cells.dataset.stone)], row = lastUpTo(stone.rank, rank);
      cells.querySelector(".speed").textContent = row < 0 ? "—" : `${number(stone.speed[row], 2)} m/s`;
      const turns = row >= 0 && stone.turns;
      cells.querySelector(".spin").textContent = turns ? `${number(stone.omega[row], 2)} rad/s` : "—";
    }
  }

  /** Lay a model's simulation over the measured shot; none for "". */
  choose(model) {
    this.model = model;
    for (const [trail, ghost] of this.ghosts.values()) {
      trail.through([]);
      ghost.show(false);
    }
    for (const stone of this.simulations[model] ?? []) {
      if (stone.x.length < 2) continue;
      const [trail, ghost] = this.ghosts.get(stone.name);
      trail.through(Array.from(stone.x, (x, k) => [x, stone.y[k]]));
      ghost.turns(stone.turns);
    }
    this.draw(this.rank);
  }
}

/** Speed of each stone that moves against time, with a cursor that is also a handle. */
class SpeedChart {
  constructor(svg, player) {
    const W = Math.max(Math.min(svg.clientWidth, 760), 320), H = 228, left = 38, right = 14, top = 26, bottom = 26;
    svg.setAttribute("viewBox", `0 0 ${W} ${H}`);
    const { times } = player, t0 = times[0], t1 = Math.max(times[times.length - 1], t0 + 0.01);
    const moving = player.stones.filter(moves);
    const fastest = Math.max(0.1, ...moving.map((stone) => most(stone.speed)));
    const step = [0.05, 0.1, 0.25, 0.5, 1, 2, 5].find((s) => fastest / s <= 5) ?? 10;
    const high = Math.ceil(fastest / step) * step;
    const x = (t) => left + ((t - t0) / (t1 - t0)) * (W - left - right);
    const y = (v) => H - bottom - (v / high) * (H - top - bottom);
    const text = (value, attributes, name = "tick") => {
      svgElement("text", { class: name, ...attributes }, svg).textContent = value;
    };
    for (let v = 0; v <= high + 1e-9; v += step) {
      svgElement("line", { class: "grid", x1: left, x2: W - right, y1: y(v), y2: y(v) }, svg);
      text(number(v, step < 0.1 ? 2 : step < 1 && step !== 0.5 ? 2 : 1), { x: left - 6, y: y(v) + 3.5, "text-anchor": "end" });
    }
    const every = [0.1, 0.2, 0.5, 1, 2, 5, 10, 30, 60, 300].find((s) => (t1 - t0) / s <= 9) ?? 600;
    for (let t = Math.ceil(t0 / every) * every; t <= t1 + 1e-9; t += every) {
      text(number(t, every < 1 ? 1 : 0), { x: x(t), y: H - bottom + 14, "text-anchor": "middle" });
    }
    text("speed (m/s)", { x: 0, y: 9 }, "axis");
    text("time (s)", { x: W - right, y: H - 3, "text-anchor": "end" }, "axis");
    const groups = []; // hits too close for a label each share one
    player.data.hits.forEach((hit, k) => {
      const at = x(hit.t), last = groups[groups.length - 1];
      svgElement("line", { class: "moment", x1: at, x2: at, y1: top, y2: H - bottom }, svg);
      if (last && at - last.at < 14) last.ranks.push(k + 1);
      else groups.push({ at, ranks: [k + 1] });
    });
    for (const { at, ranks } of groups) text(ranks.join(", "), { x: at, y: top - 3, "text-anchor": "middle" });
    const moments = player.data.hits.map((hit) => hit.t);
    for (const stone of moving) {
      // A hit lies between two frames: no line leads from the one to the other.
      const d = stone.t.map((t, k) => {
        const cut = k === 0 || moments.some((moment) => stone.t[k - 1] < moment && moment <= t);
        return `${cut ? "M" : "L"}${x(t).toFixed(1)} ${y(stone.speed[k]).toFixed(1)}`;
      });
      svgElement("path", { class: "curve", stroke: stone.colour, d: d.join("") }, svg);
    }
    this.cursor = svgElement("line", { class: "cursor", y1: top - 2, y2: H - bottom }, svg);
    this.x = x;
    const seek = (event) => {
      const box = svg.getBoundingClientRect();
      const t = t0 + (((event.clientX - box.left) / box.width * W - left) / (W - left - right)) * (t1 - t0);
      player.seek(Math.max(lastUpTo(times, t), 0));
    };
    svg.addEventListener("pointerdown", (event) => { svg.setPointerCapture(event.pointerId); seek(event); });
    svg.addEventListener("pointermove", (event) => { if (event.buttons) seek(event); });
  }

  mark(t) {
    this.cursor.setAttribute("x1", this.x(t));
    this.cursor.setAttribute("x2", this.x(t));
  }
}

const shotData = JSON.parse(byId("shot-data").textContent);
const player = new Player(shotData);
