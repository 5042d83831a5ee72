// Error against time, both logarithmic: one curve for each estimator that was tried.

const SVG = "http://www.w3.org/2000/svg";
const FRAME = { left: 62, right: 14, top: 12, bottom: 36, width: 480, height: 268 };

/** What an axis never gets shorter than: seconds, relative error. */
const LEAST = { x: [0.5, 20], y: [0.05, 1] };

/** Makes an element of the drawing. */
function shape(name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) {
        element.setAttribute(key, value);
    }
    if (text !== undefined) {
        element.textContent = text;
    }
    return element;
}

/** The powers of ten around some values, and the mapping to coordinates. */
function axis(values, [low, high], from, to) {
    const range = [Math.min(low, ...values), Math.max(high, ...values)].map(Math.log10);
    const at = (value) => from + ((Math.log10(value) - range[0]) / (range[1] - range[0])) * (to - from);
    const ticks = [];
    for (let decade = Math.floor(range[0]); decade <= range[1]; decade++) {
        for (const digit of [1, 2, 3, 4, 5, 6, 7, 8, 9]) {
            const value = Number(`${digit}e${decade}`);
            const place = Math.log10(value);
            if (place >= range[0] - 1e-9 && place <= range[1] + 1e-9) {
                ticks.push({ value, digit });
            }
        }
    }
    // Labels at 1, and at 2 and 5 while there is room.
    const labelled = range[1] - range[0] < 2.2 ? [1, 2, 5] : [1];
    ticks.forEach((tick) => (tick.label = labelled.includes(tick.digit)));
    return { at, ticks };
}

/** A duration for people. */
export function duration(seconds) {
    if (seconds < 60) {
        return `${Number(seconds.toPrecision(seconds < 10 ? 2 : 3))} s`;
    }
    const minutes = seconds / 60;
    return minutes < 60 ? `${Number(minutes.toPrecision(2))} min` : `${Number((minutes / 60).toPrecision(2))} h`;
}

/** A share for people. */
export function percent(share) {
    return `${Number((100 * share).toPrecision(2))} %`;
}

/** Draws `curves`: `{ name, color, active, points: [{ seconds, error }] }`. */
export function draw(svg, curves) {
    const { left, right, top, bottom, width, height } = FRAME;
    const [x0, x1, y0, y1] = [left, width - right, height - bottom, top];
    const points = curves.flatMap((curve) => curve.points);
    const x = axis(points.map((p) => p.seconds), LEAST.x, x0, x1);
    const y = axis(points.map((p) => p.error), LEAST.y, y0, y1);
    const grid = shape("g", {});
    for (const { value, label } of x.ticks) {
        const at = x.at(value).toFixed(1);
        grid.append(shape("line", { x1: at, x2: at, y1: y0, y2: y1, class: label ? "grid" : "fine" }));
        if (label) {
            grid.append(shape("text", { x: at, y: y0 + 15, "text-anchor": "middle" }, duration(value)));
        }
    }
    for (const { value, label } of y.ticks) {
        const at = y.at(value).toFixed(1);
        grid.append(shape("line", { x1: x0, x2: x1, y1: at, y2: at, class: label ? "grid" : "fine" }));
        if (label) {
            grid.append(shape("text", { x: x0 - 6, y: Number(at) + 4, "text-anchor": "end" }, percent(value)));
        }
    }
    grid.append(shape("text", { x: (x0 + x1) / 2, y: height - 4, "text-anchor": "middle", class: "name" }, "render time"));
    const name = { x: 0, y: 0, "text-anchor": "middle", class: "name", transform: `translate(10 ${(y0 + y1) / 2}) rotate(-90)` };
    grid.append(shape("text", name, "relative error"));
    const clip = shape("clipPath", { id: "inside" });
    clip.append(shape("rect", { x: x0, y: y1, width: x1 - x0, height: y0 - y1 }));
    const inside = shape("g", { "clip-path": "url(#inside)" });
    svg.replaceChildren(grid, clip, inside);
    for (const curve of curves.filter(({ points: p }) => p.length > 0)) {
        if (curve.active) {
            inside.append(...guide(curve, x, y, x0, x1));
        }
        const path = curve.points.map((p) => `${x.at(p.seconds).toFixed(1)},${y.at(p.error).toFixed(1)}`);
        const style = { stroke: curve.color, class: curve.active ? "curve active" : "curve" };
        inside.append(shape("polyline", { points: path.join(" "), ...style }));
        const [cx, cy] = path.at(-1).split(",");
        svg.append(shape("circle", { cx, cy, r: curve.active ? 4 : 3, fill: curve.color }));
    }
}

/** The line of slope −1/2 that fits a curve best: what independent samples follow. */
function guide({ points }, x, y, x0, x1) {
    const logs = points.map((p) => Math.log(p.error) + Math.log(p.seconds) / 2);
    const level = Math.exp(logs.reduce((sum, l) => sum + l, 0) / logs.length);
    const error = (seconds) => level / Math.sqrt(seconds);
    // The axis is a logarithm: two points make the line.
    const [a, b] = [1e-3, 1e6];
    const ends = { x1: x.at(a), y1: y.at(error(a)), x2: x.at(b), y2: y.at(error(b)) };
    const slope = (ends.y2 - ends.y1) / (ends.x2 - ends.x1);
    const inside = ends.x1 + (FRAME.top + 20 - ends.y1) / slope; // from where on the label is below the frame's top
    const label = { x: Math.max(x0 + (x1 - x0) * 0.3, inside), class: "guide" };
    label.y = ends.y1 + slope * (label.x - ends.x1) - 7;
    label.transform = `rotate(${(Math.atan(slope) * 180) / Math.PI} ${label.x} ${label.y})`;
    const text = shape("text", label, "∝ N");
    text.append(shape("tspan", { dy: -4, "font-size": 9 }, "−1/2"));
    return [shape("line", { ...ends, class: "guide" }), text];
}
