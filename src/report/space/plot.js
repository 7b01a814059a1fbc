// Along the chosen ray: density, opacity, transmittance and weight over t, and the samples' colors below. Numbers alone go into the SVG.

const PLOT = { width: 400, height: 190, left: 30, right: 392, top: 8, bottom: 140 };
// Told apart by their dashes too.
const CURVES = [
  { of: "sigmas", name: "σ", color: "#8a63c9", dash: "1 3", scaled: true },
  { of: "alphas", name: "α", color: "#d07f1f", dash: "6 3" },
  { of: "transmittances", name: "T", color: "#2f8fd0", dash: "" },
  { of: "weights", name: "w", color: "#c93f6d", dash: "", wide: true },
];

function plot(r) {
  const t = ofRay("t", r, samples);
  const x = (at) => PLOT.left + ((at - data.near) / (data.far - data.near)) * (PLOT.right - PLOT.left);
  const y = (share) => PLOT.bottom - share * (PLOT.bottom - PLOT.top);
  const parts = [];
  for (const share of hasField ? [0, 0.5, 1] : []) {
    parts.push(`<line x1="${PLOT.left}" x2="${PLOT.right}" y1="${y(share)}" y2="${y(share)}" stroke="var(--line)"/>`);
    parts.push(`<text x="${PLOT.left - 5}" y="${y(share) + 4}" text-anchor="end">${share}</text>`);
  }
  const names = [];
  for (const curve of CURVES.filter(({ of }) => arrays[of])) {
    const values = [...ofRay(curve.of, r, samples)];
    const most = curve.scaled ? Math.max(...values) || 1 : 1;
    const line = values.map((value, n) => `${x(t[n]).toFixed(1)},${y(value / most).toFixed(1)}`).join(" ");
    parts.push(`<polyline points="${line}" fill="none" stroke="${curve.color}" stroke-width="${curve.wide ? 2.5 : 1.5}" stroke-dasharray="${curve.dash}"/>`);
    names.push({ ...curve, name: curve.scaled ? `σ / ${figure(Number(most.toPrecision(3)))}` : curve.name });
  }
  for (let n = 0; n < samples; n++) {
    const end = n + 1 < samples ? t[n + 1] : data.far;
    const color = hasField ? css([...ofRay("rgbs", r * samples + n, 3)]) : "var(--accent)";
    const width = hasField ? Math.max(x(end) - x(t[n]), 0.5) : 1;
    parts.push(`<rect x="${x(t[n]).toFixed(2)}" y="${PLOT.bottom + 4}" width="${width.toFixed(2)}" height="10" fill="${color}"/>`);
  }
  for (const [at, anchor] of [[data.near, "start"], [data.far, "end"]]) {
    parts.push(`<text x="${x(at)}" y="${PLOT.bottom + 28}" text-anchor="${anchor}">t = ${figure(Number(at.toPrecision(4)))}</text>`);
  }
  names.forEach(({ name, color, dash, wide }, n) => {
    const left = PLOT.left + n * 88;
    parts.push(`<line x1="${left}" x2="${left + 22}" y1="${PLOT.bottom + 43}" y2="${PLOT.bottom + 43}" stroke="${color}" stroke-width="${wide ? 2.5 : 1.5}" stroke-dasharray="${dash}"/>`);
    parts.push(`<text x="${left + 27}" y="${PLOT.bottom + 47}">${name}</text>`);
  });
  const what = hasField ? "Density, opacity, transmittance and weight along the ray" : "Samples along the ray";
  const [top, height] = hasField ? [0, PLOT.height] : [PLOT.bottom, 34];
  return `<svg viewBox="0 ${top} ${PLOT.width} ${height}" role="img" aria-label="${what}" font-size="11" fill="currentColor">${parts.join("")}</svg>`;
}
