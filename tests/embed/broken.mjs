// Damages blobs, a byte at a time: each must be refused with a reason or be a scene that renders, never a trap.
// node broken.mjs etendue.wasm FOLDER
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { EtendueError, Scene, load } from "../../kernel/examples/web/etendue.js";

const [wasm, folder] = process.argv.slice(2);
const module = await load(await readFile(wasm));
let refused = 0;
let opened = 0;
for (const name of ["matter", "gloss", "fog", "prism", "open_air", "plan"]) {
    const whole = await readFile(join(folder, `${name}.etd`));
    const blobs = [whole.subarray(0, 0), whole.subarray(0, 100), whole.subarray(0, whole.length - 1)];
    for (let at = 0; at < whole.length; at += 61) {
        const blob = Uint8Array.from(whole);
        blob[at] ^= 0x55;
        blobs.push(blob);
    }
    for (const blob of blobs) {
        try {
            const scene = await Scene.open(module, blob, { capacity: 8 });
            opened += 1;
            if (opened % 8 === 0 && scene.width * scene.height <= 1 << 16) {
                scene.renderTile(scene.film(), {}, { estimator: "bidirectional" });
            }
        } catch (error) {
            if (!(error instanceof EtendueError)) {
                throw error;
            }
            refused += 1;
        }
    }
}
console.log(`${refused} refused, ${opened} opened`);
