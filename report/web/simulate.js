"use strict";
/* A shot simulated from hit to hit, by the equations of physics/ (impact/, simulate.py), where they
   are explained. A shot is
   {stones: [{name, x, y, vx, vy, omega, theta, mass, omega_after}],
    impact: {name, ...}, ice: {name, ..., factor}, curl: {name, ...}, radius,
    bounds: null or {play, half_width, back_line, hog_line}}. */
const simulator = (() => {
  const TOUCHING = 1e-9, PRESSED = 1e-6, SLOW = 1e-3, SIMULTANEOUS = 1e-10;
  const MAX_IMPULSES = 20000; // the page must not hang

  // ---- stone on stone

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1];

  /** Velocities and spins after a hit; n points from stone 1 to stone 2. */
  function resolve(impact, one, two, n, radius, spinAfter) {
    const t = [-n[1], n[0]];
    const reduced = (one.mass * two.mass) / (one.mass + two.mass);
    const apart = [one.v[0] - two.v[0], one.v[1] - two.v[1]];
    const along = (1 + impact.restitution) * dot(apart, n) * reduced;
    let aside = 0, spins = [one.w, two.w];
    if (impact.name === "frictional") {
      const slip = dot(apart, t) + radius * (one.w + two.w);
      const stick = (-slip * reduced) / (1 + 1 / impact.inertia);
      const limit = impact.stone_friction * Math.max(along, 0);
      aside = Math.min(Math.max(stick, -limit), limit);
      const turn = aside / (impact.inertia * radius);
      spins = [one.w + turn / one.mass, two.w + turn / two.mass];
    }
    const push = [0, 1].map((k) => along * n[k] - aside * t[k]);
    const v1 = one.v.map((v, k) => v - push[k] / one.mass);
    const v2 = two.v.map((v, k) => v + push[k] / two.mass);
    if (impact.name === "rigid-body") {
      spins = spinAfter;
      for (const k of [0, 1]) {
        v1[k] += radius * (one.w - spins[0]) * t[k];
        v2[k] -= radius * (two.w - spins[1]) * t[k];
      }
    }
    return { v1, v2, w1: spins[0], w2: spins[1] };
  }

  // ---- when two stones meet

  const distance = (p, q) => Math.hypot(p.x - q.x, p.y - q.y);

  /** Speed at which two stones close. */
  function closing(one, two) {
    const dx = two.x - one.x, dy = two.y - one.y;
    return ((one.vx - two.vx) * dx + (one.vy - two.vy) * dy) / Math.hypot(dx, dy);
  }

  /** First time after `start` at which two paths are within `reach`. */
  function firstContact(a, b, start, reach) {
    const end = Math.max(a.stop, b.stop);
    if (end <= start) return Infinity;
    const later = [[end, a.point(end), b.point(end)]];
    let [t0, a0, b0] = [start, a.point(start), b.point(start)];
    while (later.length) {
      const [t1, a1, b1] = later[later.length - 1], step = t1 - t0;
      const far = slack(a0, a1, b0, b1, step);
      const x0 = b0.x - a0.x, y0 = b0.y - a0.y, x1 = b1.x - a1.x, y1 = b1.y - a1.y;
      if (nearest(x0, y0, x1, y1) - far > reach) {
        [t0, a0, b0] = later.pop();
        continue;
      }
      if (Math.hypot(x1, y1) <= reach && far < 1e-3 * reach) return crossing(a, b, t0, t1, reach);
      const middle = t0 + step / 2;
      if (step < 1e-9 || !(t0 < middle && middle < t1)) {
        [t0, a0, b0] = later.pop(); // they graze, closer than numbers can tell
        continue;
      }
      later.push([middle, a.point(middle), b.point(middle)]);
    }
    return Infinity;
  }

  /** Bound on how far two stones can be from where their chords say. */
  function slack(a0, a1, b0, b1, step) {
    if (a0.speed === 0 || b0.speed === 0) {
      const [p0, p1] = a0.speed === 0 ? [b0, b1] : [a0, a1];
      const turn = Math.abs(p1.heading - p0.heading);
      if (turn < 1) return (distance(p0, p1) / 2) * Math.tan(turn / 2);
    }
    const spread = (p, q) => p.speed - q.speed + p.speed * Math.abs(q.heading - p.heading);
    return (step / 4) * (spread(a0, a1) + spread(b0, b1));
  }

  /** Distance of the origin from a segment. */
  function nearest(x0, y0, x1, y1) {
    const dx = x1 - x0, dy = y1 - y0, square = dx * dx + dy * dy;
    const s = square ? Math.min(Math.max(-(x0 * dx + y0 * dy) / square, 0), 1) : 0;
    return Math.hypot(x0 + s * dx, y0 + s * dy);
  }

  /** Time between `low` (apart) and `high` (within reach) at which the distance is `reach`. */
  function crossing(a, b, low, high, reach) {
    let t = (low + high) / 2;
    for (let i = 0; i < 100; i++) {
      const p = a.at(t), q = b.at(t), dx = q.x - p.x, dy = q.y - p.y, apart = Math.hypot(dx, dy);
      if (apart > reach) low = t;
      else high = t;
      const rate = ((q.vx - p.vx) * dx + (q.vy - p.vy) * dy) / apart;
      let next = rate < 0 ? t - (apart - reach) / rate : low;
      if (!(low < next && next < high)) next = (low + high) / 2;
      if (Math.abs(next - t) <= 1e-15 * Math.max(1, t)) return next;
      t = next;
    }
    return t;
  }

  // ---- where stones are in play (physics/simulator/bounds.py)

  const SHORTEST = 1e-9;

  /** How far a stone is out over the side lines or the back line; negative within. */
  const beyond = (bounds, p, radius) => Math.max(
    Math.abs(p.x) + radius - bounds.half_width,
    bounds.play * p.y - radius - bounds.back_line,
  );

  /** Bound on how far a path leaves the chord between two of its points. */
  function bow(p, q) {
    const turn = Math.abs(q.heading - p.heading);
    return turn < 2 ? (distance(p, q) / 2) * Math.tan(turn / 2) : Infinity;
  }

  /** Time at which a stone on its path leaves the play. */
  function leavesAt(path, bounds, radius, hit) {
    if (path.length === 0) return Infinity;
    const end = path.point(path.stop), later = [[path.stop, end]];
    let [t0, p0] = [path.start, path.point(path.start)];
    while (later.length) {
      const [t1, p1] = later[later.length - 1];
      const out = Math.max(beyond(bounds, p0, radius), beyond(bounds, p1, radius));
      const inside = out < -bow(p0, p1);
      if (!inside && t1 - t0 > SHORTEST) {
        const middle = t0 + (t1 - t0) / 2;
        later.push([middle, path.point(middle)]);
        continue;
      }
      if (!inside && beyond(bounds, p1, radius) >= 0) return t1;
      [t0, p0] = later.pop();
    }
    const short = bounds.play * end.y - radius < -bounds.hog_line;
    return !hit && short ? path.stop : Infinity;
  }

  // ---- from hit to hit

  class Run {
    constructor(shot) {
      this.shot = shot;
      this.t = 0;
      this.hits = [];
      this.hitCount = shot.stones.map(() => 0);
      this.paths = shot.stones.map(() => []);
      this.leaves = shot.stones.map(() => Infinity);
      this.gone = shot.stones.map(() => Infinity);
      shot.stones.forEach((stone, k) => this.setOff(k, { theta: 0, ...motionOf(stone) }));
      this.pairs = [];
      shot.stones.forEach((a, i) =>
        shot.stones.slice(i + 1).forEach((b, rank) => {
          const reach = Math.min(2 * shot.radius, distance(a, b)); // as close as they were placed
          this.pairs.push({ i, j: i + 1 + rank, reach, due: Infinity, exact: false });
        }),
      );
      this.lookAhead(this.pairs);
    }

    run() {
      for (let count = 0; ; count++) {
        if (count === MAX_IMPULSES) throw new Error("more impulses than any shot needs");
        const pair = this.nextPair();
        if (!pair) break;
        this.t = Math.max(this.t, pair.due);
        this.hit(pair);
        const { i, j } = pair;
        this.lookAhead(this.pairs.filter((p) => p.i === i || p.i === j || p.j === i || p.j === j));
      }
      return { hits: this.hits, paths: this.paths, gone: this.gone };
    }

    setOff(k, state) {
      const paths = this.paths[k];
      if (paths.length && paths[paths.length - 1].start >= this.t) paths.pop();
      const { ice, curl, bounds, radius } = this.shot, path = new motion.Path(this.t, state, ice, curl);
      paths.push(path);
      if (bounds) this.leaves[k] = leavesAt(path, bounds, radius, this.hitCount[k] > 0);
    }

    last(k) {
      return this.paths[k][this.paths[k].length - 1];
    }

    /** Bound the next contacts: the stones only get slower until they meet. */
    lookAhead(pairs) {
      const points = this.paths.map((_, k) => this.last(k).point(this.t));
      for (const pair of pairs) {
        if (this.gone[pair.i] < Infinity || this.gone[pair.j] < Infinity) continue;
        const a = points[pair.i], b = points[pair.j];
        const gap = distance(a, b) - pair.reach, speed = a.speed + b.speed;
        const far = speed === 0 || gap > this.last(pair.i).length + this.last(pair.j).length;
        pair.due = far ? Infinity : this.t + Math.max(gap, 0) / speed;
        pair.exact = false;
      }
    }

    nextPair() {
      for (;;) {
        let first = Infinity;
        for (const pair of this.pairs) first = Math.min(first, pair.due);
        const leaving = Math.min(...this.leaves);
        if (leaving < Infinity && leaving <= first) {
          this.takeAway(this.leaves.indexOf(leaving));
          continue;
        }
        if (first === Infinity) return null;
        const due = this.pairs.filter((pair) => pair.due <= first + SIMULTANEOUS);
        const unknown = due.filter((pair) => !pair.exact);
        if (!unknown.length) return due[0];
        for (const pair of unknown) {
          pair.due = this.nextContact(pair);
          pair.exact = true;
        }
      }
    }

    takeAway(k) {
      this.gone[k] = this.leaves[k];
      this.leaves[k] = Infinity;
      for (const pair of this.pairs) if (pair.i === k || pair.j === k) pair.due = Infinity;
    }

    nextContact(pair) {
      const a = this.last(pair.i), b = this.last(pair.j);
      if (a.stop <= this.t && b.stop <= this.t) return Infinity;
      const apart = distance(a.point(this.t), b.point(this.t));
      if (apart - pair.reach > a.length + b.length) return Infinity;
      let { reach } = pair;
      if (apart <= reach + TOUCHING) {
        if (closing(a.at(this.t), b.at(this.t)) > SLOW) return this.t;
        reach = Math.min(reach, apart) - PRESSED;
      }
      return firstContact(a, b, this.t, reach);
    }

    hit(pair) {
      let { i, j } = pair;
      let one = this.last(i).at(this.t), two = this.last(j).at(this.t);
      if (Math.hypot(two.vx, two.vy) > Math.hypot(one.vx, one.vy)) {
        [i, j, one, two] = [j, i, two, one];
      }
      const { shot } = this, first = shot.stones[i], second = shot.stones[j];
      const apart = distance(one, two), n = [(two.x - one.x) / apart, (two.y - one.y) / apart];
      const masses = [first.mass ?? 1, second.mass ?? 1];
      const speed = closing(one, two), listed = speed > SLOW;
      let newOne = one, newTwo = two;
      if (speed > 0) {
        const spins = listed
          ? [this.spinAfter(i, one.omega), this.spinAfter(j, two.omega)]
          : [one.omega, two.omega];
        const after = resolve(
          shot.impact,
          { v: [one.vx, one.vy], w: one.omega, mass: masses[0] },
          { v: [two.vx, two.vy], w: two.omega, mass: masses[1] },
          n, shot.radius, spins,
        );
        newOne = { ...one, vx: after.v1[0], vy: after.v1[1], omega: after.w1 };
        newTwo = { ...two, vx: after.v2[0], vy: after.v2[1], omega: after.w2 };
      }
      if (listed) {
        const place = { x: one.x + shot.radius * n[0], y: one.y + shot.radius * n[1] };
        this.hits.push({ t: this.t, stones: [first.name, second.name], ...place });
        this.hitCount[i]++;
        this.hitCount[j]++;
      }
      const overlap = pair.reach - apart;
      if (overlap > TOUCHING) {
        const share = masses[0] / (masses[0] + masses[1]); // apart about their centre of mass
        newOne = moved(newOne, n, -overlap * (1 - share));
        newTwo = moved(newTwo, n, overlap * share);
      }
      if (newOne !== one) {
        this.setOff(i, newOne);
        this.setOff(j, newTwo);
      }
    }

    spinAfter(k, omega) {
      if (this.shot.impact.name !== "rigid-body") return omega;
      const given = this.shot.stones[k].omega_after ?? [];
      if (!given.length) throw new Error(`${this.shot.stones[k].name} has no spin after the hit`);
      return given[Math.min(this.hitCount[k], given.length - 1)];
    }
  }

  const motionOf = ({ x, y, vx = 0, vy = 0, omega = 0, theta = 0 }) => ({ x, y, theta, vx, vy, omega });
  const moved = (one, n, by) => ({ ...one, x: one.x + by * n[0], y: one.y + by * n[1] });

  /** Let the stones glide and hit each other until all rest: hits, and paths by stone. */
  const simulate = (shot) => new Run(shot).run();

  /** State of stone `k` of a simulation at the time t >= 0; its last one where it has left. */
  function stateAt(simulation, k, when) {
    const paths = simulation.paths[k], t = Math.min(when, simulation.gone[k]);
    let rank = paths.length - 1;
    while (rank > 0 && paths[rank].start > t) rank--;
    return paths[rank].at(t);
  }

  /** Time at which the last stone stops, its spin included, or leaves. */
  const endOf = ({ paths, gone }) =>
    Math.max(0, ...paths.map((own, k) => Math.min(own[own.length - 1].rest, gone[k])));

  /** The shot with something changed (see physics/prediction/what_if.py); what is null stays. */
  function changed(shot, thrown, changes) {
    const { restitution, friction, stoneFriction, speed, spin, aimOffset = 0 } = changes;
    const impact = { ...shot.impact };
    if (restitution != null) impact.restitution = restitution;
    if (stoneFriction != null) impact.stone_friction = stoneFriction;
    const ice = { ...shot.ice };
    if (friction != null) ice.factor = ((ice.factor ?? 1) * friction) / motion.frictionOf(ice);
    const stones = shot.stones.map((stone, k) => {
      const was = Math.hypot(stone.vx, stone.vy);
      if (k !== thrown || was === 0) return stone;
      const ux = stone.vx / was, uy = stone.vy / was, now = speed ?? was;
      return {
        ...stone,
        x: stone.x - aimOffset * uy,
        y: stone.y + aimOffset * ux,
        vx: now * ux,
        vy: now * uy,
        omega: spin ?? stone.omega,
      };
    });
    return { ...shot, stones, impact, ice };
  }

  return { simulate, stateAt, endOf, changed };
})();
