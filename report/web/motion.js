"use strict";
/* How a stone glides, by the equations of physics/: laws of the ice and of curl, the one curve of
   all glides (physics/simulator/curve.py) and the way of a stone along it
   (physics/simulator/motion.py). SI units, radians, counter-clockwise positive. Parameters of the
   laws have the names that they have there; `factor` multiplies all friction of an ice. */
const motion = (() => {
  const GRAVITY = 9.81, REST_SPEED = 1e-9, CELLS = 1024, LOWEST_TOP = 4;

  // ---- laws of the ice

  const fading = (p, gravity) => (v) => (p.a / (v + p.v_c) + p.b) * gravity;
  const ICE = {
    constant: (p) => () => p.friction * GRAVITY,
    fit: (p) => fading(p, GRAVITY),
    fcv1: (p) => fading(p, p.gravity),
    penner: (p) => (v) => (p.friction * GRAVITY) / Math.sqrt(v),
  };
  const CURL = {
    none: () => ({ turn: () => 0, loss: () => 0 }),
    fcv1: (p) => ({
      turn: (v) => p.turn * v ** -0.8,
      loss: (v) => p.loss / Math.max(v, p.slow),
    }),
  };

  /** Deceleration (m/s²) as a function of the speed. */
  function deceleration(ice) {
    const law = ICE[ice.name](ice), factor = ice.factor ?? 1;
    return (v) => factor * law(v);
  }

  /** Friction of an ice at 1 m/s. */
  const frictionOf = (ice) => deceleration(ice)(1) / GRAVITY;

  // ---- the curve of all glides

  /** Points of Gauss and Legendre in 0..1, and integrals of their Lagrange polynomials. */
  const GAUSS = (() => {
    const far = Math.sqrt(5 + 2 * Math.sqrt(10 / 7)) / 3;
    const near = Math.sqrt(5 - 2 * Math.sqrt(10 / 7)) / 3;
    const x = [-far, -near, 0, near, far].map((z) => (z + 1) / 2);
    const polynomials = x.map((xj, j) => {
      let c = [1];
      x.forEach((xi, i) => {
        if (i === j) return;
        const longer = new Array(c.length + 1).fill(0);
        c.forEach((value, k) => {
          longer[k + 1] += value / (xj - xi);
          longer[k] -= (value * xi) / (xj - xi);
        });
        c = longer;
      });
      return c;
    });
    const integral = (c, to) => c.reduce((sum, value, k) => sum + (value * to ** (k + 1)) / (k + 1), 0);
    return {
      x,
      inner: x.map((to) => polynomials.map((c) => integral(c, to))),
      end: polynomials.map((c) => integral(c, 1)),
    };
  })();

  const [SPEED, ALONG, ASIDE, TURN, STRAIGHT, LOSS, UNWOUND] = [0, 4, 8, 12, 16, 20, 24];
  const WIDTH = 28; // coefficients of a cell: seven cubics

  const curves = new Map();

  /** The curve that reaches `speed`, integrated once for each ice and curl. */
  function curveFor(ice, curl, speed) {
    let top = LOWEST_TOP;
    while (top < speed) top *= 2;
    const key = JSON.stringify([ice, curl, top]);
    if (!curves.has(key)) {
      if (curves.size >= 32) curves.clear();
      curves.set(key, integrate(deceleration(ice), CURL[curl.name](curl), top));
    }
    return curves.get(key);
  }

  function integrate(slowing, curl, top) {
    const width = top ** 0.2 / CELLS;
    const nodes = () => new Float64Array(CELLS + 1);
    const [tau, speed, along, aside, turn, straight, loss, unwound] = Array.from({ length: 8 }, nodes);
    const over = (rates, weights) => {
      let sum = 0;
      for (let k = 0; k < 5; k++) sum += rates[k] * weights[k];
      return width * sum;
    };
    const inside = (start, rates) => GAUSS.inner.map((weights) => start + over(rates, weights));
    for (let k = 0; k < CELLS; k++) {
      const u = GAUSS.x.map((x) => width * (k + x));
      const v = u.map((value) => value ** 5);
      const dtau = u.map((value, i) => (5 * value ** 4) / slowing(v[i]));
      const step = (rates) => over(rates, GAUSS.end);
      const turning = v.map((value, i) => curl.turn(value) * dtau[i]);
      const losing = v.map((value, i) => curl.loss(value) * dtau[i]);
      const heading = inside(turn[k], turning), lost = inside(loss[k], losing);
      const way = v.map((value, i) => value * dtau[i]);
      tau[k + 1] = tau[k] + step(dtau);
      straight[k + 1] = straight[k] + step(way);
      turn[k + 1] = turn[k] + step(turning);
      along[k + 1] = along[k] + step(way.map((value, i) => value * Math.cos(heading[i])));
      aside[k + 1] = aside[k] + step(way.map((value, i) => value * Math.sin(heading[i])));
      loss[k + 1] = loss[k] + step(losing);
      unwound[k + 1] = unwound[k] + step(lost.map((value, i) => value * dtau[i]));
      speed[k + 1] = (width * (k + 1)) ** 5;
    }
    const cells = new Float64Array(CELLS * WIDTH);
    const lay = (offset, value, slope) => {
      let left = (value[1] - value[0]) / (tau[1] - tau[0]);
      for (let k = 0; k < CELLS; k++) {
        const h = tau[k + 1] - tau[k], chord = (value[k + 1] - value[k]) / h, right = slope(k + 1);
        const at = k * WIDTH + offset;
        cells[at] = value[k];
        cells[at + 1] = left;
        cells[at + 2] = (3 * chord - 2 * left - right) / h;
        cells[at + 3] = (left + right - 2 * chord) / h ** 2;
        left = right;
      }
    };
    lay(SPEED, speed, (k) => slowing(speed[k]));
    lay(ALONG, along, (k) => speed[k] * Math.cos(turn[k]));
    lay(ASIDE, aside, (k) => speed[k] * Math.sin(turn[k]));
    lay(TURN, turn, (k) => curl.turn(speed[k]));
    lay(STRAIGHT, straight, (k) => speed[k]);
    lay(LOSS, loss, (k) => curl.loss(speed[k]));
    lay(UNWOUND, unwound, (k) => loss[k]);
    return { tau, speed, loss, cells };
  }

  /** Value at `s` of the cubic whose coefficients begin at `at`. */
  const cubic = (c, at, s) => c[at] + s * (c[at + 1] + s * (c[at + 2] + s * c[at + 3]));

  /** How many of the rising values are at most `value`. */
  function bisect(values, value) {
    let low = 0, high = values.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (values[middle] <= value) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  /** Where a curve is `tau` before rest: the cell's first coefficient and the time into it. */
  function locate(curve, tau) {
    const k = Math.min(Math.max(bisect(curve.tau, tau) - 1, 0), CELLS - 1);
    return { at: k * WIDTH, s: tau - curve.tau[k] };
  }

  /** Time until rest at which a column of the curve has a value. */
  function tauAt(curve, column, offset, value) {
    const k = Math.min(bisect(column, value), CELLS) - 1, at = k * WIDTH + offset, c = curve.cells;
    const width = curve.tau[k + 1] - curve.tau[k];
    let low = 0, high = width;
    let s = c[at + 1] > 0 ? Math.min(Math.max((value - c[at]) / c[at + 1], low), high) : width / 2;
    for (let i = 0; i < 60; i++) {
      const f = cubic(c, at, s) - value;
      if (f > 0) high = s;
      else low = s;
      const slope = c[at + 1] + s * (2 * c[at + 2] + 3 * s * c[at + 3]);
      const step = slope > 0 ? s - f / slope : Infinity;
      const next = low <= step && step <= high ? step : (low + high) / 2;
      if (Math.abs(next - s) <= 1e-16 * width) return curve.tau[k] + next;
      s = next;
    }
    return curve.tau[k] + s;
  }

  // ---- the way of one stone

  /** A piece of the curve, laid where it would end at rest. */
  class Arc {
    constructor(x, y, heading, sense) {
      Object.assign(this, { x, y, heading, sense, cos: Math.cos(heading), sin: Math.sin(heading) });
    }

    /** Lay the curve through a place and a direction at `s` into a cell. */
    static through(x, y, heading, sense, c, at, s) {
      const arc = new Arc(0, 0, heading + sense * cubic(c, at + TURN, s), sense);
      const [dx, dy] = arc.place(c, at, s);
      arc.x = x - dx;
      arc.y = y - dy;
      return arc;
    }

    place(c, at, s) {
      if (!this.sense) {
        const way = cubic(c, at + STRAIGHT, s);
        return [this.x - this.cos * way, this.y - this.sin * way];
      }
      const along = cubic(c, at + ALONG, s), aside = this.sense * cubic(c, at + ASIDE, s);
      return [
        this.x - this.cos * along - this.sin * aside,
        this.y - this.sin * along + this.cos * aside,
      ];
    }

    direction(c, at, s) {
      return this.sense ? this.heading - this.sense * cubic(c, at + TURN, s) : this.heading;
    }
  }

  /** The way of one stone from a state until it rests, if nothing hits it. */
  class Path {
    constructor(start, motion, ice, curl) {
      let speed = Math.hypot(motion.vx, motion.vy);
      if (speed < REST_SPEED) {
        motion = { ...motion, vx: 0, vy: 0 };
        speed = 0;
      }
      const curve = curveFor(ice, curl, speed), c = curve.cells;
      const tau = speed ? tauAt(curve, curve.speed, SPEED, speed) : 0;
      let { at, s } = locate(curve, tau);
      Object.assign(this, { motion, curve, tau, start, stop: start + tau });
      this.length = cubic(c, at + STRAIGHT, s);
      this.loss = cubic(c, at + LOSS, s);
      this.unwound = cubic(c, at + UNWOUND, s);
      this.sense = Math.sign(motion.omega);
      const heading = Math.atan2(motion.vy, motion.vx);
      this.arc = Arc.through(motion.x, motion.y, heading, this.sense, c, at, s);
      const left = Math.abs(motion.omega) - this.loss;
      this.tauSpin = 0;
      this.straight = this.arc;
      if (left < 0 && this.sense) {
        this.tauSpin = tauAt(curve, curve.loss, LOSS, -left);
        ({ at, s } = locate(curve, this.tauSpin));
        const [x, y] = this.arc.place(c, at, s);
        this.straight = Arc.through(x, y, this.arc.direction(c, at, s), 0, c, at, s);
      }
      this.theta = this.turned(this.tauSpin);
      this.pivot = CURL[curl.name](curl).loss(0);
      this.spin = this.pivot > 0 ? Math.max(left, 0) : 0;
      this.rest = this.stop + (this.spin ? this.spin / this.pivot : 0);
    }

    /** State at the time t >= start; where it rests, from then on. */
    at(t) {
      if (t <= this.start) return this.motion;
      const tau = this.stop - t;
      if (tau <= 0) {
        const since = Math.min(-tau, this.rest - this.stop);
        const spin = t < this.rest ? this.spin - this.pivot * since : 0;
        const theta = this.theta + this.sense * (this.spin - (this.pivot * since) / 2) * since;
        const { x, y } = this.tau === 0 ? this.motion : this.straight;
        return { x, y, theta, vx: 0, vy: 0, omega: this.sense * spin };
      }
      const c = this.curve.cells, { at, s } = locate(this.curve, tau), spins = tau > this.tauSpin;
      const arc = spins ? this.arc : this.straight;
      const [x, y] = arc.place(c, at, s), heading = arc.direction(c, at, s);
      const speed = cubic(c, at + SPEED, s);
      let { omega } = this.motion, { theta } = this;
      if (this.sense && spins) {
        omega += this.sense * (cubic(c, at + LOSS, s) - this.loss);
        theta = this.turned(tau);
      } else if (this.sense) {
        omega = 0;
      }
      return { x, y, theta, vx: speed * Math.cos(heading), vy: speed * Math.sin(heading), omega };
    }

    /** Place, speed and direction at the time t >= start; at rest the last direction. */
    point(t) {
      const tau = this.stop - t;
      if (tau <= 0) {
        return { x: this.straight.x, y: this.straight.y, speed: 0, heading: this.straight.heading };
      }
      const c = this.curve.cells, { at, s } = locate(this.curve, tau);
      const arc = tau > this.tauSpin ? this.arc : this.straight, [x, y] = arc.place(c, at, s);
      return { x, y, speed: cubic(c, at + SPEED, s), heading: arc.direction(c, at, s) };
    }

    turned(tau) {
      const { at, s } = locate(this.curve, tau);
      const spin = this.motion.omega - this.sense * this.loss;
      const unwound = this.unwound - cubic(this.curve.cells, at + UNWOUND, s);
      return this.motion.theta + spin * (this.tau - tau) + this.sense * unwound;
    }
  }

  return { Path, frictionOf };
})();
