// The kernel's C functions (`kernel/include/etendue.h`) for JavaScript: browsers, workers, node.
//
//     const module = await load(bytesOfTheWasm);
//     const scene = await Scene.open(module, bytesOfTheBlob);
//     const [r, g, b] = scene.irradiance([x, y, z], [nx, ny, nz]);
//
// Each scene has an instance of the module, and so a memory, of its own: nothing is ever freed in it, it goes when the
// scene goes. What is wrong is thrown as `EtendueError`.

const ABI_VERSION = 1;
const SCENE_SIZE = 384;
const ALIGN = 16; // of blobs, scenes, scratch and films
const SETTINGS_SIZE = 72; // sizeof(EtdSettings)
const SUM_SIZE = 48; // of a pixel in a film: three integers of 128 bits

/** The estimators, by the numbers of `etendue.h`. */
export const ESTIMATORS = { path: 0, light: 1, bidirectional: 2, distributed: 3, quadrature: 4, "quadrature+path": 5 };

/** The heuristics of multiple importance sampling. */
export const HEURISTICS = { balance: 0, power: 1, cutoff: 2, maximum: 3 };

/** Where random numbers come from. The module has `sobol` only if it is built with all features. */
export const SEQUENCES = { independent: 0, sobol: 1 };

/** A status that isn't `ETD_OK`; for a damaged blob also where. */
export class EtendueError extends Error {
    constructor(message, status) {
        super(message);
        this.name = "EtendueError";
        this.status = status;
    }
}

/** Compiles the module. */
export function load(bytes) {
    return WebAssembly.compile(bytes);
}

/** Where a struct's members go in memory: numbers one after the other, each aligned to its own size. */
class Writer {
    constructor(view, at) {
        this.view = view;
        this.at = at;
    }

    u32(value) {
        this.view.setUint32(this.at, value, true);
        this.at += 4;
        return this;
    }

    u64(value) {
        this.at = (this.at + 7) & ~7;
        this.view.setBigUint64(this.at, BigInt(value), true);
        this.at += 8;
        return this;
    }

    f32(values) {
        for (const value of values) {
            this.view.setFloat32(this.at, value, true);
            this.at += 4;
        }
        return this;
    }
}

/** A scene that has been opened, with scratch memory: for one thread. */
export class Scene {
    /** Checks a blob (an `ArrayBuffer` or `Uint8Array`; it is copied) and opens it. Any bytes are safe. */
    static async open(module, blob, { capacity = 32 } = {}) {
        const scene = new Scene(await WebAssembly.instantiate(module));
        scene.#open(blob instanceof ArrayBuffer ? new Uint8Array(blob) : blob, capacity);
        return scene;
    }

    #end; // where free memory begins
    #scene;
    #scratch;
    #small; // room for structs, vectors and results

    constructor(instance) {
        this.c = instance.exports;
        this.#end = this.c.memory.buffer.byteLength;
    }

    #open(blob, capacity) {
        this.#small = this.#take(512);
        const at = this.#take(blob.length);
        this.#bytes(at, blob.length).set(blob);
        const memory = this.#take(SCENE_SIZE);
        const out = this.#small;
        const where = out + 16; // EtdBlobError
        this.#write(where).u32(16).u32(0).u32(0).u32(0);
        const status = this.c.etd_scene_open(ABI_VERSION, at, blob.length, memory, SCENE_SIZE, out, where);
        if (status >= 100) {
            const [section, record] = [this.#u32(where + 4), this.#u32(where + 8)];
            const place = section > 0 ? ` (section ${section}, record ${record})` : ""; // 0 is the header
            throw new EtendueError(this.#says(status) + place, status);
        }
        this.#check(status);
        this.#scene = this.#u32(out);
        const size = this.c.etd_scratch_size(capacity);
        this.#check(this.c.etd_scratch_init(this.#take(size), size, capacity, out));
        this.#scratch = this.#u32(out);
        this.#write(out).u32(64); // EtdSceneInfo
        this.#check(this.c.etd_scene_inspect(this.#scene, out));
        /** What it holds: the members of `EtdSceneInfo`. */
        this.info = {};
        const names = ["width", "height", "needs", "triangles", "spheres", "shapes", "materials", "textures", "emitters", "depth"];
        names.forEach((name, i) => (this.info[name] = this.#u32(out + 4 + 4 * i)));
        this.info.center = [...this.#floats(out + 48, 3)];
        this.info.radius = this.#floats(out + 60, 1)[0];
        /** Size of the image. */
        this.width = this.info.width;
        this.height = this.info.height;
    }

    /**
     * The irradiance at a point, on the side of the normal: the mean of `samples` samples of element `id`, linear RGB.
     * `settings` are those of `EtdSettings`, by name: estimator, heuristic, maxEdges, seed, sequence, roulette;
     * of distributed: branching, lightSamples; of quadrature: quadrature, steps, shift.
     */
    irradiance(position, normal, settings = {}) {
        return this.#probe(this.c.etd_estimate_irradiance, position, normal, settings);
    }

    /** The radiance that arrives at `origin` from `direction`; otherwise like `irradiance`. */
    radiance(origin, direction, settings = {}) {
        return this.#probe(this.c.etd_estimate_rays, origin, direction, settings);
    }

    #probe(estimate, position, direction, { samples = 4096, first = 0, id = 0, ...settings }) {
        const [vectors, count] = [this.#small + 64, this.#small + 128];
        this.#write(vectors).f32(position).f32(direction);
        this.#write(count).u32(24).u32(samples).u64(first).u64(id); // EtdSamples
        const s = this.#settings(settings);
        this.#check(estimate(this.#scene, s, 0, this.#scratch, vectors, vectors + 12, 1, count, this.#small));
        return this.#floats(this.#small, 3).slice();
    }

    /** Writes an `EtdSettings`; returns where. */
    #settings({
        estimator = "path", heuristic = "power", maxEdges = -1, seed = 0,
        branching = [8, 4, 2, 1], lightSamples = 4, quadrature = 4, steps = 64, shift = false,
        sequence = "independent", roulette = 0.5,
    }) {
        const at = this.#small + 256;
        this.#write(at).u32(SETTINGS_SIZE).u32(ESTIMATORS[estimator]).u32(HEURISTICS[heuristic]).u32(maxEdges).u64(seed);
        this.#bytes(at + 24, 8).fill(0).set(branching);
        this.#write(at + 32).u32(lightSamples).u32(quadrature).u32(steps).u32(shift ? 1 : 0);
        // The last three are those of chains, which have no functions here.
        this.#write(at + 48).u32(SEQUENCES[sequence]).f32([roulette, 0.1, 1 / 64, 0.3]);
        return at;
    }

    /** An empty film of this scene's image. */
    film() {
        const size = SUM_SIZE * this.width * this.height;
        return new Film(this.#take(size), this.#take(size), size);
    }

    /** Adds `samples` samples from number `first` on of each pixel of a tile to a film. */
    renderTile(film, { x = 0, y = 0, width = this.width, height = this.height, samples = 1, first = 0 }, settings = {}) {
        const at = this.#small + 128;
        this.#write(at).u32(32).u32(x).u32(y).u32(width).u32(height).u32(samples).u64(first); // EtdTile
        const s = this.#settings(settings);
        const pixels = this.width * this.height;
        this.#check(this.c.etd_render_film(this.#scene, s, 0, this.#scratch, at, film.samples, film.splats, pixels));
    }

    /** Makes all sums of a film 0. */
    clear(film) {
        this.#bytes(film.samples, film.size).fill(0);
        this.#bytes(film.splats, film.size).fill(0);
    }

    /** Adds all sums of one film to another's. */
    merge(to, from) {
        const pixels = this.width * this.height;
        this.#check(this.c.etd_film_merge(to.samples, from.samples, pixels));
        this.#check(this.c.etd_film_merge(to.splats, from.splats, pixels));
    }

    /** Rows `y` … `y + height` of `film.samples` or `film.splats` as bytes: a copy that may be sent to another thread. */
    rows(sums, y, height) {
        const row = SUM_SIZE * this.width;
        return this.#bytes(sums + row * y, row * height).slice();
    }

    /** Adds what `rows` gave there to the same rows here. */
    addRows(sums, y, bytes) {
        if (!this.staging) {
            this.staging = this.#take(SUM_SIZE * this.width * this.height);
        }
        this.#bytes(this.staging, bytes.length).set(bytes);
        const from = sums + SUM_SIZE * this.width * y;
        this.#check(this.c.etd_film_merge(from, this.staging, bytes.length / SUM_SIZE));
    }

    /** The image of a film that has `passes` samples of each pixel: linear RGB, row by row from the top. */
    resolve(film, passes) {
        const pixels = this.width * this.height;
        if (!this.image) {
            this.image = this.#take(12 * pixels);
        }
        const { samples, splats } = film;
        this.#check(this.c.etd_film_resolve(this.#scene, samples, splats, pixels, BigInt(passes), this.image));
        return this.#floats(this.image, 3 * pixels).slice();
    }

    /** Memory for good. The module's stack and data lie below; what is above is ours. */
    #take(bytes) {
        const at = (this.#end + ALIGN - 1) & -ALIGN;
        this.#end = at + bytes;
        const missing = this.#end - this.c.memory.buffer.byteLength;
        if (missing > 0) {
            this.c.memory.grow(Math.ceil(missing / 65536));
        }
        return at;
    }

    // Views are made anew each time: growing the memory detaches them.
    #bytes(at, length) {
        return new Uint8Array(this.c.memory.buffer, at, length);
    }

    #floats(at, length) {
        return new Float32Array(this.c.memory.buffer, at, length);
    }

    #u32(at) {
        return new DataView(this.c.memory.buffer).getUint32(at, true);
    }

    #write(at) {
        return new Writer(new DataView(this.c.memory.buffer), at);
    }

    #says(status) {
        const from = new Uint8Array(this.c.memory.buffer, this.c.etd_error_string(status));
        return new TextDecoder().decode(from.subarray(0, from.indexOf(0)));
    }

    #check(status) {
        if (status !== 0) {
            throw new EtendueError(this.#says(status), status);
        }
    }
}

/** Exact sums of an image, in the memory of the scene that made it: addresses of its arrays of `EtdSum`. */
class Film {
    constructor(samples, splats, size) {
        Object.assign(this, { samples, splats, size });
    }
}

/** FNV-1a of 64 bits over the bits of numbers, as 16 digits: equal images have equal hashes on every machine. */
export function hash(floats) {
    // In 16-bit limbs, because a product of two has to stay exact.
    let [a, b, c, d] = [0x2325, 0x8422, 0x9ce4, 0xcbf2];
    for (const byte of new Uint8Array(floats.buffer, floats.byteOffset, floats.byteLength)) {
        a ^= byte;
        // Times 2^40 + 0x1b3.
        const [p, q, r, s] = [a * 0x1b3, b * 0x1b3, c * 0x1b3 + a * 0x100, d * 0x1b3 + b * 0x100];
        a = p & 0xffff;
        const carry = q + (p >>> 16);
        b = carry & 0xffff;
        const next = r + (carry >>> 16);
        c = next & 0xffff;
        d = (s + (next >>> 16)) & 0xffff;
    }
    return [d, c, b, a].map((limb) => limb.toString(16).padStart(4, "0")).join("");
}
