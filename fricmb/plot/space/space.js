// A scene in space on a canvas: turned by dragging, solids behind first.
(function (canvas, sketch, redraw) {
  let azimuth = -58 * Math.PI / 180, elevation = 22 * Math.PI / 180, held = null;
  canvas.style.cursor = "grab";
  canvas.onpointerdown = e => { held = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); canvas.style.cursor = "grabbing"; };
  canvas.onpointermove = e => {
    if (!held) return;
    azimuth -= 0.01 * (e.clientX - held[0]);
    elevation = Math.min(1.57, Math.max(-1.57, elevation + 0.01 * (e.clientY - held[1])));
    held = [e.clientX, e.clientY]; redraw();
  };
  canvas.onpointerup = canvas.onpointercancel = () => { held = null; canvas.style.cursor = "grab"; };

  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const sum = (a, b, s) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = a => sum([0, 0, 0], a, 1 / (Math.hypot(...a) || 1));
  const LIGHT = unit([0.3, -0.5, 0.81]);
  function turn(q) {  // rows of the rotation matrix of a quaternion (x, y, z, w)
    const s = 1 / Math.hypot(...q), [x, y, z, w] = q.map(c => c * s);
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
      [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
      [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]];
  }
  function shade(colour, normal) {
    const bright = 0.75 + 0.25 * dot(normal, LIGHT), c = colour.replace("#", "");
    return "rgb(" + [0, 2, 4].map(k => Math.round(bright * parseInt(c.slice(k, k + 2), 16))).join(",") + ")";
  }
  function helix(a, b, radius, coils) {  // a spring from b to a
    const along = sum(a, b, -1), e = unit(along), k = [0, 1, 2].reduce((m, c) => Math.abs(e[c]) < Math.abs(e[m]) ? c : m, 0);
    const u = unit(cross(e, [0, 1, 2].map(c => c === k ? 1 : 0))), v = cross(e, u), points = [b];
    for (let n = 0; n <= 16 * coils; n++) {
      const g = 2 * Math.PI * n / 16, s = 0.12 + 0.76 * n / (16 * coils);
      points.push(sum(sum(sum(b, along, s), u, radius * Math.cos(g)), v, radius * Math.sin(g)));
    }
    points.push(a);
    return points;
  }

  return function (p, w, h, colour, between, i, share) {
    const ca = Math.cos(azimuth), sa = Math.sin(azimuth), cb = Math.cos(elevation), sb = Math.sin(elevation);
    const right = [-sa, ca, 0], up = [-sb * ca, -sb * sa, cb], towards = [cb * ca, cb * sa, sb];
    const middle = sketch.box.map(b => (b[0] + b[1]) / 2), wide = Math.hypot(...sketch.box.map(b => b[1] - b[0]));
    const scale = 1.15 * Math.min(w, h) / wide, size = Math.max(...sketch.box.map(b => b[1] - b[0]));
    const at = q => { const d = sum(q, middle, -1); return [w / 2 + scale * dot(d, right), h / 2 - scale * dot(d, up)]; };
    const trace = points => { p.beginPath(); points.map(at).forEach((q, k) => p[k ? "lineTo" : "moveTo"](q[0], q[1])); };
    const stroke = points => { trace(points); p.stroke(); };
    const pose = sketch.solids.map(s => ({ place: s.place.map(v => between(v, i, share)), rows: turn(s.turn.map(v => between(v, i, share))) }));
    const put = (k, q) => k < 0 ? q : sum(pose[k].place, pose[k].rows.map(row => dot(row, q)), 1);
    const ahead = (k, q) => pose[k].rows.map(row => dot(row, q));

    p.strokeStyle = colour.quiet; p.lineWidth = 0.7;
    for (const f of sketch.floors) {
      const g = between(f.angle, i, share), c = Math.cos(g), s = Math.sin(g);
      const u = sum(sum([0, 0, 0], f.frame[0], c), f.frame[1], s), v = sum(sum([0, 0, 0], f.frame[1], c), f.frame[0], -s);
      for (let k = 0; k <= 8; k++) {
        const x = f.half * (k / 4 - 1);
        for (const [a, b] of [[u, v], [v, u]]) stroke([-1, 1].map(y => sum(sum(f.through, a, y * f.half), b, x)));
      }
    }
    p.lineWidth = 2; sketch.rails.forEach(stroke); p.lineWidth = 0.7;
    for (const s of sketch.solids) if (s.path) stroke(s.place[0].map((_, k) => s.place.map(v => v[Math.min(k, v.length - 1)])));

    const order = pose.map((q, k) => [dot(q.place, towards), k]).sort((a, b) => a[0] - b[0]);
    for (const [, k] of order) {
      const solid = sketch.solids[k], faces = [];
      solid.faces.forEach((face, n) => {
        const points = face.map(q => put(k, q)), normal = unit(cross(sum(points[1], points[0], -1), sum(points[2], points[0], -1)));
        if (dot(normal, towards) > 0) faces.push([points.reduce((d, q) => d + dot(q, towards), 0) / points.length, points, normal, solid.shades[n]]);
      });
      faces.sort((a, b) => a[0] - b[0]);
      for (const [, points, normal, dark] of faces) {
        p.fillStyle = p.strokeStyle = shade(dark ? colour.stick : colour.body, normal); p.lineWidth = 0.5;
        trace(points); p.closePath(); p.fill(); p.stroke();
      }
      p.strokeStyle = colour.line; p.lineWidth = 0.9;
      solid.lines.forEach((line, n) => { if (dot(ahead(k, solid.outward[n]), towards) >= 0) stroke(line.map(q => put(k, q))); });
    }
    p.strokeStyle = colour.line; p.lineWidth = 1.2;
    for (const l of sketch.links) {
      const a = put(l.a[0], l.a[1]), b = put(l.b[0], l.b[1]);
      if (l.kind === "spring") stroke(helix(a, b, 0.015 * size, 7));
      else stroke([a, b]);
      if (l.kind === "damper") stroke(helix(sum(b, sum(a, b, -1), 0.6), sum(b, sum(a, b, -1), 0.4), 0.022 * size, 3));
    }
    const round = (q, r, face) => { p.beginPath(); p.arc(...at(q), r, 0, 2 * Math.PI); p.fillStyle = face; p.fill(); p.stroke(); };
    p.lineWidth = 1;
    for (const pin of sketch.pins) round(put(pin[0], pin[1]), 3, colour.paper);
    for (const c of sketch.touches) {
      const q = c.at.map(v => between(v, i, share)), mode = c.mode.length > 1 ? c.mode[share > 0.5 ? i + 1 : i] : c.mode[0];
      p.strokeStyle = colour.line; p.lineWidth = 1;
      round(q, 4.5, [colour.stick, colour.slip, colour.paper][mode]);
      if (!c.force) continue;
      const force = c.force.map(v => 0.22 * size * between(v, i, share)), long = Math.hypot(...force);
      if (long < 0.004 * size) continue;
      const e = unit(force), n = Math.hypot(e[0], e[1]) > 1e-6 ? unit(cross(e, [0, 0, 1])) : [1, 0, 0], tip = sum(q, force, 1);
      p.strokeStyle = colour.ink; p.lineWidth = 2.4;
      stroke([q, tip]); stroke([1, 0, -1].map(s => s ? sum(sum(tip, e, -0.25 * long), n, 0.125 * s * long) : tip));
    }
    p.fillStyle = colour.ink; p.textAlign = "center"; p.textBaseline = "bottom";
    sketch.solids.forEach((s, k) => { const [x, y] = at(sum(pose[k].place, up, s.reach)); p.fillText(s.name, x, y - 2); });
    p.fillStyle = colour.quiet; p.textAlign = "right"; p.fillText("drag to turn", w - 8, h - 6);
  };
})
