// The suite of renders that has the same bits everywhere: node bits.mjs etendue.wasm FOLDER
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { Scene, hash, load } from "../../kernel/examples/web/etendue.js";

const [wasm, folder] = process.argv.slice(2);
// Lines say the heuristic, or the numbers where they aren't independent.
const suite = [
    ["path", "balance"],
    ["path", "maximum"],
    ["path", "sobol"],
    ["light", "power"],
    ["bidirectional", "balance"],
    ["bidirectional", "power"],
    ["bidirectional", "cutoff"],
    ["bidirectional", "maximum"],
    ["bidirectional", "sobol"],
    ["distributed", "power"],
    ["quadrature", "power"],
    ["quadrature+path", "power"],
];
const small = { branching: [2, 2, 1], lightSamples: 2, quadrature: 2, steps: 4 };
const passes = 2;
const UNSUPPORTED = 7; // ETD_E_UNSUPPORTED

const module = await load(await readFile(wasm));
for (const name of ["matter", "gloss", "fog", "prism", "round", "open_air", "plan"]) {
    const scene = await Scene.open(module, await readFile(join(folder, `${name}.etd`)), { capacity: 8 });
    const film = scene.film();
    for (const [estimator, how] of suite) {
        const by = how === "sobol" ? { sequence: how } : { heuristic: how };
        const settings = { estimator, ...by, ...small, seed: 3 };
        scene.clear(film);
        try {
            scene.renderTile(film, { samples: passes }, settings);
        } catch (error) {
            // Lights that quadrature makes nothing of.
            if (estimator === "quadrature" && error.status === UNSUPPORTED) {
                continue;
            }
            throw error;
        }
        const image = hash(scene.resolve(film, passes));
        // Irradiance at the middle of the scene, and radiance along a ray from there.
        const probes = [];
        const { center } = scene.info;
        for (let first = 0; first < 8; first++) {
            const one = { ...settings, samples: 1, first };
            probes.push(...scene.irradiance(center, [0, 0, 1], { ...one, id: 1 }));
            probes.push(...scene.radiance(center, [0, 0, -1], { ...one, id: 2 }));
        }
        console.log(`${name} ${estimator} ${how} ${image} ${hash(new Float32Array(probes))}`);
    }
}
