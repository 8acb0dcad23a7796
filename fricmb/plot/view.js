(function () {
  const data = DATA, root = document.currentScript.parentElement;
  const one = name => root.querySelector(name), TAU = 2 * Math.PI;
  const scene = one("canvas.scene"), time = one("canvas.time"), plane = one("canvas.plane");
  const play = one("button.play"), slider = one("input"), speed = one("select.speed"), clock = one("output");
  const first = one("select.first"), second = one("select.second"), across = one("select.across"), up = one("select.up");
  const told = one(".told");
  const whole = [data.t[0], data.t[data.t.length - 1]];
  let span = data.span.slice(), now = span[0], running = false, last = 0, seconds = data.seconds;

  // ---- colours, canvases
  let colour = {};
  function readColours() {
    const style = getComputedStyle(root);
    for (const name of ["paper", "ink", "quiet", "grid", "body", "moved", "stick", "slip", "shade", "second", "line"])
      colour[name] = style.getPropertyValue("--" + name).trim();
  }
  function pen(canvas) {
    const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
    }
    const p = canvas.getContext("2d");
    p.setTransform(ratio, 0, 0, ratio, 0, 0);
    p.fillStyle = colour.paper; p.fillRect(0, 0, width, height);
    p.font = "12px system-ui, sans-serif"; p.lineJoin = "round"; p.setLineDash([]);
    return [p, width, height];
  }

  // ---- values between the times that are here
  function place(t) {  // number of the last time at or before t
    let low = 0, high = data.t.length - 1;
    while (high - low > 1) { const middle = (low + high) >> 1; if (data.t[middle] <= t) low = middle; else high = middle; }
    return low;
  }
  function between(values, i, share) {
    if (values.length === 1) return values[0];
    return values[i] + share * (values[i + 1] - values[i]);
  }
  function moment(t) {
    const i = place(t), gap = data.t[i + 1] - data.t[i];
    return [i, gap > 0 ? Math.min(1, Math.max(0, (t - data.t[i]) / gap)) : 0];
  }

  // ---- axes
  function ticks(low, high, count) {
    const raw = (high - low) / count, ten = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map(m => m * ten).find(s => s >= raw * 0.999), found = [];
    for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return [found, step];
  }
  function number(x, step) {
    if (Math.abs(x) < 1e-9 * step) return "0";
    const size = Math.max(Math.abs(x), step);
    if (size >= 1e5 || step < 1e-4) return x.toExponential(Math.max(0, Math.min(6, Math.round(Math.log10(size / step)))));
    return x.toFixed(Math.max(0, Math.min(8, -Math.floor(Math.log10(step) + 1e-9))));
  }
  function limits(low, high) {
    if (!(high > low)) { const room = Math.abs(low) * 0.1 || 1; return [low - room, high + room]; }
    return [low - 0.05 * (high - low), high + 0.05 * (high - low)];
  }
  function axes(p, box, x, y, xlabel, ylabel) {
    const [left, top, right, bottom] = box;
    const px = v => left + (v - x[0]) / (x[1] - x[0]) * (right - left);
    const py = v => bottom - (v - y[0]) / (y[1] - y[0]) * (bottom - top);
    p.strokeStyle = colour.grid; p.fillStyle = colour.ink; p.lineWidth = 1;
    const [xs, xstep] = ticks(x[0], x[1], Math.max(2, Math.floor((right - left) / 90)));
    const [ys, ystep] = ticks(y[0], y[1], Math.max(2, Math.floor((bottom - top) / 45)));
    p.textAlign = "center"; p.textBaseline = "top";
    for (const v of xs) { line(p, [[px(v), top], [px(v), bottom]]); p.fillText(number(v, xstep), px(v), bottom + 5); }
    p.textAlign = "right"; p.textBaseline = "middle";
    for (const v of ys) { line(p, [[left, py(v)], [right, py(v)]]); p.fillText(number(v, ystep), left - 5, py(v)); }
    p.strokeStyle = colour.quiet; line(p, [[left, top], [left, bottom], [right, bottom]]);
    p.textAlign = "center"; p.textBaseline = "bottom"; p.fillText(xlabel, (left + right) / 2, bottom + 36);
    p.save(); p.translate(12, (top + bottom) / 2); p.rotate(-Math.PI / 2); p.textBaseline = "middle";
    p.fillText(ylabel, 0, 0); p.restore();
    return [px, py];
  }
  function line(p, points) {
    p.beginPath();
    points.forEach((q, k) => p[k ? "lineTo" : "moveTo"](q[0], q[1]));
    p.stroke();
  }
  function clip(p, box, draw) {
    p.save(); p.beginPath(); p.rect(box[0], box[1], box[2] - box[0], box[3] - box[1]); p.clip(); draw(); p.restore();
  }

  // ---- signals over time
  const label = n => n + (data.labels[n] ? " [" + data.labels[n] + "]" : "");
  function shown() {  // places of the times of the span, one beyond each end
    return [Math.max(0, place(span[0])), Math.min(data.t.length - 1, place(span[1]) + 1)];
  }
  // times are close enough for swings in the stretch shown first; beyond it bounds stand in for them
  const beyond = 0.02 * (data.span[1] - data.span[0]);
  const coarse = () => data.bounds && (span[0] < data.span[0] - beyond || span[1] > data.span[1] + beyond);
  const timeBox = (w, h) => [70, 10, w - 12, h - 44];
  function drawTime() {
    const [p, w, h] = pen(time), box = timeBox(w, h), [from, to] = shown();
    const names = [first.value, second.value].filter(n => n);
    let low = Infinity, high = -Infinity;
    for (const n of names) {
      if (coarse()) for (const k of [0, 1]) for (const v of data.bounds.values[n][k]) { low = Math.min(low, v); high = Math.max(high, v); }
      else for (let i = from; i <= to; i++) { low = Math.min(low, data.signals[n][i]); high = Math.max(high, data.signals[n][i]); }
    }
    const y = limits(low, high), owner = names[0].split(".")[0];
    const contact = data.stick[owner] ? owner : data.touching[owner], stuck = data.stick[contact] || [];
    const across = t => box[0] + (t - span[0]) / (span[1] - span[0]) * (box[2] - box[0]);
    p.fillStyle = colour.shade;
    for (const [a, b] of stuck) if (b > span[0] && a < span[1])
      p.fillRect(across(Math.max(a, span[0])), box[1], Math.max(1, across(Math.min(b, span[1])) - across(Math.max(a, span[0]))), box[3] - box[1]);
    const [px, py] = axes(p, box, span, y, data.time ? "time [" + data.time + "]" : "time", names.length > 1 ? "" : label(names[0]));
    clip(p, box, () => names.forEach((n, k) => {
      p.strokeStyle = p.fillStyle = k ? colour.second : colour.stick; p.lineWidth = 1.5; p.setLineDash(k ? [7, 4] : []);
      if (coarse()) {
        const t = data.bounds.t, [bottom, top] = data.bounds.values[n];
        p.globalAlpha = 0.55; p.beginPath();
        for (let i = 0; i < t.length; i++) p[i ? "lineTo" : "moveTo"](px(t[i]), py(top[i]));
        for (let i = t.length - 1; i >= 0; i--) p.lineTo(px(t[i]), py(bottom[i]));
        p.closePath(); p.fill(); p.stroke(); p.globalAlpha = 1;
      } else {
        p.beginPath();
        for (let i = from; i <= to; i++) p[i > from ? "lineTo" : "moveTo"](px(data.t[i]), py(data.signals[n][i]));
        p.stroke();
      }
    }));
    p.setLineDash([]); p.strokeStyle = colour.ink; p.lineWidth = 1; line(p, [[px(now), box[1]], [px(now), box[3]]]);
    const [i, share] = moment(now);
    names.forEach((n, k) => {
      p.fillStyle = k ? colour.second : colour.stick; p.beginPath();
      p.arc(px(now), py(between(data.signals[n], i, share)), 4, 0, TAU); p.fill();
    });
    told.textContent = names.map(n => label(n) + " = " + between(data.signals[n], i, share).toPrecision(5)).join("   ")
      + (stuck.length ? "   (shaded: " + contact + " sticks)" : "");
  }

  // ---- one signal over another
  function drawPlane() {
    const [p, w, h] = pen(plane), box = [70, 10, w - 12, h - 44], X = data.signals[across.value], Y = data.signals[up.value];
    const [from, to] = coarse() ? [place(data.span[0]), place(data.span[1])] : shown();
    let x = [Infinity, -Infinity], y = [Infinity, -Infinity];
    for (let i = from; i <= to; i++) {
      x = [Math.min(x[0], X[i]), Math.max(x[1], X[i])]; y = [Math.min(y[0], Y[i]), Math.max(y[1], Y[i])];
    }
    const [px, py] = axes(p, box, limits(...x), limits(...y), label(across.value), label(up.value));
    clip(p, box, () => {
      p.strokeStyle = colour.stick; p.lineWidth = 1.2; p.beginPath();
      for (let i = from; i <= to; i++) p[i > from ? "lineTo" : "moveTo"](px(X[i]), py(Y[i]));
      p.stroke();
      const [i, share] = moment(now);
      p.fillStyle = colour.slip; p.beginPath(); p.arc(px(between(X, i, share)), py(between(Y, i, share)), 5, 0, TAU); p.fill();
    });
  }

  // ---- the scene
  const inSpace = data.space ? SPACE(scene, data.space, () => drawScene()) : null;
  function drawScene() {
    const sketch = data.sketch;
    if (inSpace) {
      const [p, w, h] = pen(scene), [i, share] = moment(now);
      inSpace(p, w, h, colour, between, i, share); legend(p, data.space.touches);
      return;
    }
    if (!sketch || !scene) return;
    const [p, w, h] = pen(scene), [left, right, bottom, top] = sketch.view;
    const scale = Math.min(w / (right - left), h / (top - bottom));
    const mx = w / 2 - scale * (left + right) / 2, my = h / 2 + scale * (bottom + top) / 2;
    const at = q => [mx + scale * q[0], my - scale * q[1]], [i, share] = moment(now), unit = sketch.unit;
    const pose = sketch.places.map(row => row.map(values => between(values, i, share)));
    const put = (k, q) => {
      if (k < 0) return q;
      const [x, y, a] = pose[k], c = Math.cos(a), s = Math.sin(a);
      return [x + c * q[0] - s * q[1], y + s * q[0] + c * q[1]];
    };
    const spot = s => put(s[0], [s[1], s[2]]), turn = s => s[0] < 0 ? 0 : pose[s[0]][2];
    const stroke = points => line(p, points.map(at));
    const fill = (points, face) => {
      p.beginPath(); points.map(at).forEach((q, k) => p[k ? "lineTo" : "moveTo"](q[0], q[1])); p.closePath();
      p.fillStyle = face; p.fill(); p.stroke();
    };
    const round = (q, r, face) => { p.beginPath(); p.arc(...at(q), Math.max(2.5, r * scale), 0, TAU); p.fillStyle = face; p.fill(); p.stroke(); };
    p.strokeStyle = colour.quiet; p.lineWidth = 1;
    if (sketch.floor !== null) {
      stroke([[left, sketch.floor], [right, sketch.floor]]);
      for (let x = left; x < right; x += 0.2) stroke([[x, sketch.floor], [x - 0.12, sketch.floor - 0.15]]);
    }
    const circle = (q, r, a, b) => Array.from({ length: 41 }, (_, k) => { const g = a + (b - a) * k / 40; return [q[0] + r * Math.cos(g), q[1] + r * Math.sin(g)]; });
    for (const m of sketch.marks) {
      const q = spot(m.at), g = turn(m.at) + m.angle, e = [Math.cos(g), Math.sin(g)];
      if (m.kind === "line") stroke([[q[0] - m.size * e[0], q[1] - m.size * e[1]], [q[0] + m.size * e[0], q[1] + m.size * e[1]]]);
      if (m.kind === "circle") stroke(circle(q, m.size, 0, TAU));
    }
    sketch.shapes.forEach((s, k) => {
      if (s.face === "dot" || s.face === "ring") return;
      p.strokeStyle = colour.line; p.lineWidth = 1.2;
      p.globalAlpha = s.face === "plate" ? 0.8 : 1;
      fill(s.outline.map(q => put(k, q)), s.face === "moved" ? colour.moved : colour.body);
      p.globalAlpha = 1; p.lineWidth = 1;
      s.marks.forEach(m => stroke(m.map(q => put(k, q))));
      if (sketch.strokes[k]) {
        const shift = between(sketch.strokes[k], i, share), count = Math.max(1, Math.round(s.band / 0.5)), step = s.band / count;
        const half = Math.max(...s.outline.map(q => q[1]));
        for (let n = 0; n < count; n++) {
          const x = (((n * step + shift) % s.band) + s.band) % s.band - s.band / 2;
          stroke([[x, -half], [x, -0.55 * half]].map(q => put(k, q)));
        }
      }
    });
    p.strokeStyle = colour.line; p.lineWidth = 1.3;
    for (const l of sketch.links) {
      p.strokeStyle = l.idle ? colour.quiet : colour.line;
      const a = spot(l.a), b = spot(l.b), d = [a[0] - b[0], a[1] - b[1]], long = Math.hypot(...d) || 1e-12;
      const e = [d[0] / long, d[1] / long], n = [-e[1], e[0]];
      const go = (s, c) => [b[0] + s * d[0] + (c + l.side * unit) * n[0], b[1] + s * d[1] + (c + l.side * unit) * n[1]];
      if (l.kind === "spring") {
        const points = [go(0, 0), go(0.14, 0)], count = 2 * l.coils;
        for (let k = 0; k < count; k++) points.push(go(0.14 + 0.72 * (k + 1) / (count + 1), 0.22 * l.wide * unit * (k % 2 ? -1 : 1)));
        points.push(go(0.86, 0), go(1, 0)); stroke(points);
      } else if (l.kind === "damper") {
        const half = Math.min(0.35 * unit / long, 0.3), wide = 0.2 * l.wide * unit;
        stroke([go(0, 0), go(0.5 - half, 0)]); stroke([go(0.5, 0), go(1, 0)]);
        stroke([go(0.5 + half, wide), go(0.5 - half, wide), go(0.5 - half, -wide), go(0.5 + half, -wide)]);
        stroke([go(0.5, 0.75 * wide), go(0.5, -0.75 * wide)]);
      } else if (l.kind === "play") {
        const half = Math.min(0.12 * unit / long, 0.2), wide = 0.3 * unit;
        stroke([go(0, 0), go(0.5 - half, 0)]); stroke([go(0.5 + half, 0), go(1, 0)]);
        for (const s of [0.5 - half, 0.5 + half]) stroke([go(s, wide), go(s, -wide)]);
      } else stroke([a, b]);
    }
    p.strokeStyle = colour.line;
    for (const m of sketch.marks) {
      const q = spot(m.at), g = turn(m.at) + m.angle, e = [Math.cos(g), Math.sin(g)], n = [-e[1], e[0]];
      const by = (x, y) => [q[0] + unit * x, q[1] + unit * y], along = (s, c) => [q[0] + unit * (s * e[0] + c * n[0]), q[1] + unit * (s * e[1] + c * n[1])];
      if (m.kind === "support") {
        stroke([by(-0.8, -1.1), by(0, 0), by(0.8, -1.1), by(-0.8, -1.1)]);
        for (const x of [-0.6, 0, 0.6]) stroke([by(x, -1.1), by(x - 0.3, -1.5)]);
      } else if (m.kind === "wall") {
        const tall = m.size ? m.size / unit : 0.35;
        stroke([along(0, -tall), along(0, tall)]);
        for (const x of [-0.57, -0.17, 0.23, 0.6, 1]) stroke([along(0, tall * x), along(0.57 * tall, tall * (x - 0.43))]);
      } else if (m.kind === "pin") round(q, 0.32 * unit, colour.paper);
      else if (m.kind === "weld") round(q, 0.3 * unit, colour.line);
      else if (m.kind === "spiral") stroke(Array.from({ length: 61 }, (_, k) => { const a = 5 * Math.PI * k / 60, r = unit * (0.3 + 0.9 * k / 60); return [q[0] + r * Math.cos(a), q[1] + r * Math.sin(a)]; }));
      else if (m.kind === "turn") {
        stroke(circle(q, 1.5 * unit, 0.6, 2.4));
        const tip = by(1.5 * Math.cos(2.4), 1.5 * Math.sin(2.4)), f = [Math.sin(2.4), -Math.cos(2.4)], o = [Math.cos(2.4), Math.sin(2.4)];
        stroke([1, 0, -1].map(s => s ? [tip[0] + 0.35 * unit * (f[0] + 0.6 * s * o[0]), tip[1] + 0.35 * unit * (f[1] + 0.6 * s * o[1])] : tip));
      }
    }
    sketch.shapes.forEach((s, k) => {
      if (s.face === "dot" || s.face === "ring") { p.lineWidth = 1.2; fill(s.outline.map(q => put(k, q)), s.face === "dot" ? colour.line : colour.paper); }
    });
    const size = Math.max(7, Math.min(13, 0.36 * scale * sketch.letters));
    p.font = size + "px system-ui, sans-serif"; p.textBaseline = "middle";
    sketch.shapes.forEach((s, k) => {
      p.fillStyle = colour.ink; p.textAlign = s.face === "plate" ? "left" : "center";
      const middle = s.marks.length ? [pose[k][0] + s.label[0], pose[k][1] + s.label[1]] : put(k, s.label);
      p.fillText(s.name, ...at(middle));
    });
    for (const c of sketch.touches) {
      const q = spot(c.at), mode = c.mode.length > 1 ? c.mode[share > 0.5 ? i + 1 : i] : c.mode[0];
      const fx = between(c.force[0], i, share), fy = between(c.force[1], i, share), reach = sketch.reach;
      p.strokeStyle = colour.quiet; p.lineWidth = 1.2;
      if (c.limit && !c.turns) {
        const r = reach * between(c.limit, i, share), e = c.along, n = [-0.12 * reach * e[1], 0.12 * reach * e[0]];
        p.setLineDash([4, 3]);
        if (c.planar) stroke(circle(q, r, 0, TAU));
        p.setLineDash([]);
        if (!c.planar) for (const s of [-1, 1]) stroke([[q[0] + s * r * e[0] - n[0], q[1] + s * r * e[1] - n[1]], [q[0] + s * r * e[0] + n[0], q[1] + s * r * e[1] + n[1]]]);
      }
      p.strokeStyle = colour.line; p.lineWidth = 1;
      round(q, (c.turns ? 0.3 : 0.16) * unit, mode === 0 ? colour.stick : mode === 1 ? colour.slip : colour.paper);
      p.strokeStyle = colour.ink; p.lineWidth = 2.4;
      const long = Math.hypot(fx, fy);
      if (c.turns) stroke(circle(q, 0.62 * unit, Math.PI / 2, Math.PI / 2 + 1.5 * Math.PI * fx));
      else if (long > 0.02) {
        const e = [fx / long, fy / long], n = [-e[1], e[0]], tip = [q[0] + reach * fx, q[1] + reach * fy], head = 0.25 * reach * Math.min(1, 2 * long);
        stroke([q, tip]);
        stroke([1, 0, -1].map(s => s ? [tip[0] - head * (e[0] + 0.5 * s * n[0]), tip[1] - head * (e[1] + 0.5 * s * n[1])] : tip));
      }
    }
    legend(p, sketch.touches);
  }
  function legend(p, touches) {
    if (!touches.length) return;
    p.font = "12px system-ui, sans-serif"; p.textAlign = "left"; p.textBaseline = "middle";
    let x = 12;
    for (const [name, face] of [["stick", colour.stick], ["slip", colour.slip], ["open", colour.paper]]) {
      if (!touches.some(c => c.mode.includes({ stick: 0, slip: 1, open: 2 }[name]))) continue;
      p.fillStyle = face; p.strokeStyle = colour.line; p.lineWidth = 1; p.beginPath(); p.arc(x, 12, 5, 0, TAU); p.fill(); p.stroke();
      p.fillStyle = colour.ink; p.fillText(name, x + 10, 12); x += 24 + p.measureText(name).width;
    }
    p.strokeStyle = colour.ink; p.lineWidth = 2.4; line(p, [[x, 12], [x + 16, 12]]);
    p.fillText("friction force", x + 22, 12);
  }

  // ---- time goes on
  function draw() {
    slider.value = String(Math.round(1000 * (now - span[0]) / (span[1] - span[0])));
    clock.textContent = "t = " + now.toPrecision(6) + (data.time ? " " + data.time : "");
    drawScene(); drawTime(); drawPlane();
  }
  function step(stamp) {
    if (!running) return;
    const rate = (span[1] - span[0]) / seconds * Number(speed.value);
    now += Math.min(0.1, (stamp - last) / 1000) * rate; last = stamp;
    if (now >= span[1]) now = span[0];
    draw(); requestAnimationFrame(step);
  }
  function start(on) {
    running = on; play.textContent = on ? "Pause" : "Play"; play.setAttribute("aria-pressed", String(on));
    if (on) requestAnimationFrame(stamp => { last = stamp; step(stamp); });
  }
  function see(from, to) {
    const length = Math.max(to - from, 1e-6 * (whole[1] - whole[0]));
    span = [Math.max(whole[0], from), Math.min(whole[1], from + length)];
    const ratio = (span[1] - span[0]) / (data.span[1] - data.span[0]);
    seconds = Math.min(20, Math.max(1, data.seconds * ratio));
    now = Math.min(Math.max(now, span[0]), span[1]); draw();
  }
  play.onclick = () => start(!running);
  slider.oninput = () => { start(false); now = span[0] + slider.value / 1000 * (span[1] - span[0]); draw(); };
  one("button.whole").onclick = () => see(...whole);
  one("button.part").onclick = () => { now = data.span[0]; see(...data.span); };
  one("button.nearer").onclick = () => { const l = (span[1] - span[0]) / 4; see(now - l, now + l); };
  one("button.farther").onclick = () => { const l = span[1] - span[0]; see(now - l, now + l); };
  const reach = e => {
    const box = time.getBoundingClientRect(), [left, , right] = timeBox(time.clientWidth, time.clientHeight);
    now = span[0] + Math.min(1, Math.max(0, (e.clientX - box.left - left) / (right - left))) * (span[1] - span[0]); draw();
  };
  let held = false;
  time.onpointerdown = e => { held = true; start(false); time.setPointerCapture(e.pointerId); reach(e); };
  time.onpointermove = e => { if (held) reach(e); };
  time.onpointerup = time.onpointercancel = () => { held = false; };
  time.ondblclick = () => see(...whole);
  for (const s of [first, second, across, up]) s.onchange = draw;
  first.value = data.first; second.value = ""; across.value = data.plane[0]; up.value = data.plane[1];
  const again = () => { readColours(); draw(); };
  window.addEventListener("resize", again);
  const dark = window.matchMedia ? window.matchMedia("(prefers-color-scheme: dark)") : null;
  if (dark && dark.addEventListener) dark.addEventListener("change", again);
  if (window.MutationObserver) new MutationObserver(again).observe(document.documentElement, { attributes: true, attributeFilter: ["data-theme"] });
  again();
})();
