// The page: controls, picture, numbers, chart. `build` joins it with the other scripts; workers run the same text.
import { Scene, hash, load } from "./etendue.js";
import { Pool, Render } from "./render.js";
import { draw, duration, percent } from "./chart.js";
import { serve } from "./worker.js";

/** The estimators that the page offers, and what they look like in the chart: tell-apart colours for all eyes (Okabe and Ito). */
const COLORS = { path: "#e69f00", light: "#56b4e9", bidirectional: "#2fbf8f" };

/** Most pixels of an image: each takes 96 bytes of film in every worker. */
const MOST_PIXELS = 1 << 20;

const element = (id) => document.getElementById(id);

/** The bytes of an element that holds them in base 64. */
function decode(node) {
    return Uint8Array.from(atob(node.textContent), (c) => c.charCodeAt(0));
}

/** The page's state and what changes it. */
class Page {
    async start() {
        const wishes = new URLSearchParams(location.hash.slice(1));
        this.limit = Number(wishes.get("spp")) || Infinity;
        this.estimator = wishes.get("estimator") in COLORS ? wishes.get("estimator") : "path";
        const cores = navigator.hardwareConcurrency || 2;
        this.workers = Math.min(Math.max(Number(wishes.get("workers")) || cores, 1), 64);
        this.running = true;
        this.turn = 0; // answers to jobs of an earlier turn are dropped
        this.stops = 0;
        const wasm = decode(element("wasm"));
        this.module = await load(wasm);
        const failed = (message) => this.fail(message);
        this.pool = new Pool(element("script").textContent, wasm, (answer) => this.answer(answer), failed);
        this.controls();
        const scene = wishes.get("scene") ?? element("scene").options[0].value;
        element("scene").value = scene;
        await this.open(scene, decode(element(`scene-${scene}`)));
    }

    /** Opens a blob; if it is refused, says why and goes on with what there was. */
    async open(name, blob) {
        try {
            const scene = await Scene.open(this.module, blob);
            if (scene.width * scene.height > MOST_PIXELS) {
                throw new Error(`${scene.width} × ${scene.height} pixels; this page has room for 2²⁰ of them`);
            }
            this.scene = scene;
            this.total = scene.film();
        } catch (error) {
            this.fail(`${name}: ${error.message}`);
            return;
        }
        this.blob = blob;
        this.name = name;
        this.renders = {};
        this.fail("");
        const canvas = element("image");
        [canvas.width, canvas.height] = [this.scene.width, this.scene.height];
        this.pixels = canvas.getContext("2d").createImageData(canvas.width, canvas.height);
        const { triangles, spheres, emitters } = this.scene.info;
        const count = (n, what) => (n > 0 ? [`${n} ${what}${n > 1 ? "s" : ""}`] : []);
        const held = [...count(triangles, "triangle"), ...count(spheres, "sphere"), ...count(emitters, "light")];
        element("about").textContent = `${canvas.width} × ${canvas.height} · ${held.join(", ")} · ${blob.length} bytes`;
        this.restart();
    }

    /** New workers, same scene. What was rendered stays. */
    restart() {
        this.pool.start(this.workers, this.blob);
        this.choose(this.estimator);
    }

    /** Goes on with the image of an estimator. */
    choose(estimator) {
        this.estimator = estimator;
        document.querySelector(`input[value=${estimator}]`).checked = true;
        this.render = this.renders[estimator] ??= new Render(this.scene, estimator);
        this.render.rewind();
        this.turn += 1;
        this.run(this.running);
        this.show();
    }

    /** Goes on or pauses. */
    run(running) {
        this.tick();
        this.running = running;
        element("pause").textContent = running ? "Pause" : "Go on";
        document.documentElement.dataset.state = running ? "running" : "paused";
        this.deal();
        this.show();
    }

    /** Time counts while it renders. */
    tick() {
        const now = performance.now();
        if (this.running && this.render && !this.finished()) {
            this.render.seconds += (now - (this.since ?? now)) / 1000;
        }
        this.since = now;
    }

    finished() {
        return this.render.passes >= this.limit;
    }

    deal() {
        if (!this.running) {
            return;
        }
        this.pool.deal(() => {
            const job = this.render.deal();
            return job.pass < this.limit ? { ...job, turn: this.turn } : null;
        });
    }

    answer(answer) {
        if (answer.job.turn !== this.turn) {
            this.deal();
            return;
        }
        this.tick();
        if (this.render.take(answer)) {
            this.render.measure(this.total);
            this.show();
        }
        this.deal();
    }

    /** Shows a line about what went wrong, or nothing. */
    fail(message) {
        element("error").textContent = message;
        element("error").hidden = message === "";
    }

    /** Draws at the next occasion, at most ten times a second. */
    show() {
        const wait = 100 - (performance.now() - (this.shown ?? 0));
        this.waiting ??= setTimeout(() => {
            this.waiting = undefined;
            this.paint();
            this.shown = performance.now();
        }, Math.max(wait, 0));
    }

    paint() {
        const image = this.render.image(this.total);
        const bits = new Uint32Array(image.buffer);
        const level = this.tone();
        const { data } = this.pixels;
        for (let i = 0, j = 0; i < bits.length; i += 3, j += 4) {
            data[j] = level[bits[i] >>> 15];
            data[j + 1] = level[bits[i + 1] >>> 15];
            data[j + 2] = level[bits[i + 2] >>> 15];
            data[j + 3] = 255;
        }
        element("image").getContext("2d").putImageData(this.pixels, 0, 0);
        this.numbers(image);
    }

    /** Levels of the screen (the curve of sRGB) for the upper bits of positive numbers, at this exposure. */
    tone() {
        if (this.level?.stops !== this.stops) {
            const bits = Uint32Array.from({ length: 1 << 16 }, (_, i) => (i << 15) | (1 << 14));
            const scale = 2 ** this.stops;
            this.level = Uint8ClampedArray.from(new Float32Array(bits.buffer), (value) => {
                const x = Math.min(value * scale, 1);
                return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
            });
            this.level.stops = this.stops;
        }
        return this.level;
    }

    numbers(image) {
        const { passes, seconds, curve } = this.render;
        const rate = (passes * this.scene.width * this.scene.height) / Math.max(seconds, 1e-3);
        element("passes").textContent = passes;
        element("rate").textContent = passes > 0 ? millions(rate) : "–";
        element("seconds").textContent = clock(seconds);
        element("relative").textContent = curve.length > 0 ? percent(curve.at(-1).error) : "–";
        this.compare();
        const still = !this.running || this.finished();
        element("hash").textContent = still ? `image ${hash(image)}` : "";
        if (this.finished()) {
            Object.assign(document.documentElement.dataset, { state: "done", passes, hash: hash(image) });
        }
    }

    /** Chart and table of all estimators that were tried on this scene. */
    compare() {
        const names = Object.keys(COLORS);
        const curves = names.map((name) => {
            const points = this.renders[name]?.curve ?? [];
            return { name, points, color: COLORS[name], active: name === this.estimator };
        });
        draw(element("chart"), curves);
        for (const { name, points } of curves) {
            const render = this.renders[name];
            const last = points.at(-1);
            const pixels = this.scene.width * this.scene.height;
            const cells = last
                ? [render.passes, millions((render.passes * pixels) / render.seconds), percent(last.error)]
                : ["–", "–", "–"];
            // Independent samples: the error falls with the square root of time.
            cells.push(last ? duration(last.seconds * (last.error / 0.01) ** 2) : "–");
            const row = element(`row-${name}`);
            row.classList.toggle("active", name === this.estimator);
            [...row.querySelectorAll("td")].forEach((cell, i) => (cell.textContent = cells[i]));
        }
    }

    controls() {
        const workers = element("workers");
        const counts = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64].filter((n) => n <= 2 * this.workers);
        const all = [...new Set([...counts, this.workers])].sort((a, b) => a - b);
        workers.replaceChildren(...all.map((n) => new Option(n, n, false, n === this.workers)));
        workers.onchange = () => {
            this.workers = Number(workers.value);
            this.restart();
        };
        element("scene").onchange = ({ target }) => this.open(target.value, decode(element(`scene-${target.value}`)));
        document.querySelectorAll("input[name=estimator]").forEach((input) => {
            input.onchange = () => this.choose(input.value);
        });
        const exposure = element("exposure");
        const expose = (stops) => {
            this.stops = exposure.value = stops;
            element("stops").textContent = `${stops > 0 ? "+" : stops < 0 ? "−" : "±"}${Math.abs(stops).toFixed(1)}`;
            if (this.render) {
                this.show();
            }
        };
        exposure.oninput = () => expose(Number(exposure.value));
        exposure.ondblclick = () => expose(0);
        element("pause").onclick = () => this.run(!this.running);
        element("reset").onclick = () => {
            this.render.clear();
            this.choose(this.estimator);
        };
        element("file").onchange = ({ target }) => this.file(target.files[0]);
        element("open").onclick = () => element("file").click();
        document.ondragover = (event) => event.preventDefault();
        document.ondrop = (event) => {
            event.preventDefault();
            this.file(event.dataTransfer.files[0]);
        };
    }

    /** Opens a file of the user's. */
    async file(file) {
        if (!file) {
            return;
        }
        await this.open(file.name, new Uint8Array(await file.arrayBuffer()));
        if (this.name === file.name) {
            element("scene").selectedIndex = -1;
        }
    }
}

/** A rate for people. */
function millions(rate) {
    return rate >= 1e6 ? `${(rate / 1e6).toFixed(2)} M` : `${Math.round(rate / 1e3)} k`;
}

function clock(seconds) {
    const whole = Math.floor(seconds);
    return seconds < 60 ? `${seconds.toFixed(1)} s` : `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

if (typeof document === "undefined") {
    serve();
} else {
    const page = new Page();
    page.start().catch((error) => page.fail(error.message));
}
