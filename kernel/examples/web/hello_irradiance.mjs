// How much light falls on a point: node hello_irradiance.mjs etendue.wasm SCENE.etd x y z nx ny nz
import { readFile } from "node:fs/promises";
import { Scene, load } from "./etendue.js";

const [wasm, blob, ...numbers] = process.argv.slice(2);
const [x, y, z, nx, ny, nz] = numbers.map(Number);

try {
    const module = await load(await readFile(wasm));
    const scene = await Scene.open(module, await readFile(blob));
    const rgb = scene.irradiance([x, y, z], [nx, ny, nz], { samples: 4096 });
    const digits = (value) => String(Number(value.toPrecision(6)));
    console.log(`${[...rgb].map(digits).join(" ")} W/m2`);
} catch (error) {
    console.error(error.message);
    process.exitCode = 1;
}
