(function () {
  const data = DATA, root = document.currentScript.parentElement;
  const canvas = root.querySelector("canvas"), pen = canvas.getContext("2d"), note = root.querySelector("span");
  const chosen = root.querySelectorAll("select"), colours = ["#006BA4", "#C85200"];
  const full = [data.t[0], data.t[data.t.length - 1]];
  let span = full, from = null;
  const left = 110, right = 1690, top = 10, bottom = 560;
  const place = t => left + (t - span[0]) / (span[1] - span[0]) * (right - left);
  const time = e => {
    const box = canvas.getBoundingClientRect();
    const x = (e.clientX - box.left) / box.width * canvas.width;
    return span[0] + Math.min(1, Math.max(0, (x - left) / (right - left))) * (span[1] - span[0]);
  };
  function ticks(low, high, count) {
    const raw = (high - low) / count, ten = Math.pow(10, Math.floor(Math.log10(raw)));
    const step = [1, 2, 5, 10].map(m => m * ten).find(s => s >= raw), found = [];
    for (let x = Math.ceil(low / step) * step; x <= high; x += step) found.push(x);
    return found;
  }
  function draw() {
    pen.fillStyle = "white"; pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.font = "20px sans-serif"; pen.lineWidth = 1; pen.fillStyle = "#e3ecf4";
    const name = chosen[0].value, owner = name.split(".")[0];
    const stuck = data.stick[owner] || data.stick[Object.keys(data.stick)[0]] || [];
    for (const [a, b] of stuck)
      if (b > span[0] && a < span[1])
        pen.fillRect(place(Math.max(a, span[0])), top, Math.max(1, place(Math.min(b, span[1])) - place(Math.max(a, span[0]))), bottom - top);
    const inside = data.t.map((t, i) => i).filter(i => data.t[i] >= span[0] && data.t[i] <= span[1]);
    const names = [name, chosen[1].value].filter(n => n);
    let low = Infinity, high = -Infinity;
    for (const n of names) for (const i of inside) {
      low = Math.min(low, data.signals[n][i]); high = Math.max(high, data.signals[n][i]);
    }
    if (!(high > low)) { low -= 1; high += 1; }
    const level = y => bottom - (y - low) / (high - low) * (bottom - top);
    pen.fillStyle = "#333"; pen.strokeStyle = "#ddd";
    for (const t of ticks(span[0], span[1], 10)) {
      pen.strokeRect(place(t), top, 0, bottom - top); pen.fillText(String(+t.toPrecision(6)), place(t) - 15, bottom + 28);
    }
    for (const y of ticks(low, high, 6)) {
      pen.strokeRect(left, level(y), right - left, 0); pen.fillText(String(+y.toPrecision(4)), 4, level(y) + 7);
    }
    names.forEach((n, k) => {
      pen.strokeStyle = colours[k]; pen.lineWidth = 2; pen.setLineDash(k ? [10, 5] : []); pen.beginPath();
      inside.forEach((i, j) => pen[j ? "lineTo" : "moveTo"](place(data.t[i]), level(data.signals[n][i])));
      pen.stroke();
    });
    pen.setLineDash([]);
    note.textContent = "stick shaded; drag to enlarge, double click for the whole run";
  }
  canvas.onmousedown = e => { from = time(e); };
  canvas.onmouseup = e => {
    const to = time(e);
    if (from !== null && Math.abs(to - from) > 0.005 * (span[1] - span[0]))
      span = [Math.min(from, to), Math.max(from, to)];
    from = null; draw();
  };
  canvas.ondblclick = () => { span = full; draw(); };
  canvas.onmousemove = e => {
    const t = time(e), i = Math.min(data.t.length - 1, Math.round((t - full[0]) / (full[1] - full[0]) * (data.t.length - 1)));
    note.textContent = "t = " + data.t[i] + ", " + chosen[0].value + " = " + data.signals[chosen[0].value][i];
  };
  chosen.forEach(c => { c.onchange = draw; });
  draw();
})();
