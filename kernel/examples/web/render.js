// Progressive rendering: passes dealt to workers, films merged here.

/** Bands of rows that a pass is dealt in. */
const BANDS = 4;

/** Jobs that a worker has before it: one to do, one to go on with. */
const AHEAD = 2;

/**
 * The image of one scene by one estimator: whole passes, the even and the odd ones apart, so that their difference tells
 * the error. Passes are added in their order, whichever worker did them: the same number of them has the same bits.
 */
export class Render {
    constructor(scene, estimator) {
        this.scene = scene;
        this.estimator = estimator;
        this.halves = [scene.film(), scene.film()];
        this.clear();
    }

    /** Begins anew. */
    clear() {
        this.passes = 0;
        this.seconds = 0;
        /** Measured errors: `{ passes, seconds, error }`. */
        this.curve = [];
        this.rewind();
        this.halves.forEach((film) => this.scene.clear(film));
    }

    /** Forgets what was begun and not finished. */
    rewind() {
        this.dealt = BANDS * this.passes;
        this.begun = new Map(); // pass → answers
    }

    /** The next job, as the worker gets it. */
    deal() {
        const [pass, band] = [Math.floor(this.dealt / BANDS), this.dealt % BANDS];
        this.dealt += 1;
        const row = (i) => Math.floor((i * this.scene.height) / BANDS);
        return { estimator: this.estimator, pass, y: row(band), height: row(band + 1) - row(band) };
    }

    /** Takes a worker's answer; whether a pass is complete now. */
    take(answer) {
        const { pass } = answer.job;
        this.begun.set(pass, [...(this.begun.get(pass) ?? []), answer]);
        const before = this.passes;
        while (this.begun.get(this.passes)?.length === BANDS) {
            const film = this.halves[this.passes % 2];
            for (const { job, samples, splats } of this.begun.get(this.passes)) {
                this.scene.addRows(film.samples, job.y, samples);
                if (splats) {
                    this.scene.addRows(film.splats, 0, splats);
                }
            }
            this.begun.delete(this.passes);
            this.passes += 1;
        }
        return this.passes > before;
    }

    /** The image so far, linear RGB. `total` is a film to work in. */
    image(total) {
        this.scene.clear(total);
        this.halves.forEach((half) => this.scene.merge(total, half));
        return this.scene.resolve(total, Math.max(this.passes, 1));
    }

    /** Measures the error, where the passes are even and more by a sixth than at the last point. */
    measure(total) {
        const last = this.curve.at(-1)?.passes ?? 0;
        if (this.passes % 2 === 0 && this.passes > last * 1.16) {
            const [a, b] = this.halves.map((half) => this.scene.resolve(half, this.passes / 2));
            const error = relativeError(this.image(total), a, b, this.scene.width);
            if (error > 0) {
                this.curve.push({ passes: this.passes, seconds: this.seconds, error });
            }
        }
    }
}

/**
 * The square root of the mean over pixels and channels of variance/(near² + 0.01·m²): relMSE as `etendue compare` has it, but
 * with `near`, the mean of the pixel's neighbourhood, for a reference. Divided by itself, a pixel that is mostly noise would
 * seem to be right. Half the difference of two halves, squared, is an unbiased estimate of the variance of their mean.
 */
function relativeError(image, a, b, width) {
    const mean = image.reduce((sum, x) => sum + x, 0) / image.length;
    const floor = 0.01 * mean * mean;
    const rows = blur(image, 3, width, 3 * width, image.length / (3 * width));
    const near = blur(rows, 3 * width, image.length / (3 * width), 3, width);
    let sum = 0;
    for (let i = 0; i < image.length; i++) {
        const difference = (a[i] - b[i]) / 2;
        sum += (difference * difference) / (near[i] * near[i] + floor);
    }
    return Math.sqrt(sum / image.length);
}

/** Means of up to 17 neighbours along lines: `count` pixels `step` apart in each of `lines` lines `stride` apart. */
function blur(image, step, count, stride, lines) {
    const RADIUS = 8;
    const means = new Float64Array(image.length);
    for (let line = 0; line < lines; line++) {
        for (let channel = 0; channel < 3; channel++) {
            const at = (i) => line * stride + i * step + channel;
            let sum = 0;
            for (let i = -RADIUS; i < count; i++) {
                sum += i + RADIUS < count ? image[at(i + RADIUS)] : 0;
                sum -= i - RADIUS > 0 ? image[at(i - RADIUS - 1)] : 0;
                if (i >= 0) {
                    means[at(i)] = sum / (Math.min(i + RADIUS, count - 1) - Math.max(i - RADIUS, 0) + 1);
                }
            }
        }
    }
    return means;
}

/** Workers that all have the same scene. */
export class Pool {
    /** `source` is the workers' script; `answered` gets their answers, `failed` what goes wrong, in words. */
    constructor(source, wasm, answered, failed) {
        this.url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
        Object.assign(this, { wasm, answered, failed, workers: [] });
    }

    /** Ends the workers there are and starts `count` with this scene. */
    start(count, blob) {
        this.workers.forEach(({ worker }) => worker.terminate());
        this.workers = Array.from({ length: count }, () => {
            const entry = { worker: new Worker(this.url), jobs: 0 };
            entry.worker.onmessage = ({ data }) => {
                entry.jobs -= 1;
                data.error ? this.failed(data.error) : this.answered(data);
            };
            entry.worker.onerror = (event) => this.failed(event.message || "a worker could not start");
            entry.worker.postMessage({ wasm: this.wasm, blob });
            return entry;
        });
    }

    /** Deals jobs from `next`, which returns null when there are none, to the workers that want some. */
    deal(next) {
        for (let round = 0; round < AHEAD; round++) {
            for (const entry of this.workers.filter(({ jobs }) => jobs <= round)) {
                const job = next();
                if (!job) {
                    return;
                }
                entry.worker.postMessage({ job });
                entry.jobs += 1;
            }
        }
    }
}
