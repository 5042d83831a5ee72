// The suite of renders that has the same bits everywhere: node bits.mjs etendue.wasm FOLDER
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { Scene, hash, load } from "../../kernel/examples/web/etendue.js";

const [wasm, folder] = process.argv.slice(2);
const suite = [
    ["path", "balance"],
    ["path", "maximum"],
    ["light", "power"],
    ["bidirectional", "balance"],
    ["bidirectional", "power"],
    ["bidirectional", "cutoff"],
    ["bidirectional", "maximum"],
];
const passes = 2;

const module = await load(await readFile(wasm));
for (const name of ["matter", "gloss", "fog", "prism", "open_air", "plan"]) {
    const scene = await Scene.open(module, await readFile(join(folder, `${name}.etd`)), { capacity: 8 });
    const film = scene.film();
    for (const [estimator, heuristic] of suite) {
        const settings = { estimator, heuristic, seed: 3 };
        scene.clear(film);
        scene.renderTile(film, { samples: passes }, settings);
        const image = hash(scene.resolve(film, passes));
        // Irradiance at the middle of the scene, and radiance along a ray from there.
        const probes = [];
        const { center } = scene.info;
        for (let first = 0; first < 8; first++) {
            const one = { ...settings, samples: 1, first };
            probes.push(...scene.irradiance(center, [0, 0, 1], { ...one, id: 1 }));
            probes.push(...scene.radiance(center, [0, 0, -1], { ...one, id: 2 }));
        }
        console.log(`${name} ${estimator} ${heuristic} ${image} ${hash(new Float32Array(probes))}`);
    }
}
