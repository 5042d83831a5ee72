// What runs in a worker: an own copy of module and blob, and one film that is emptied for each job.
import { Scene, load } from "./etendue.js";

/**
 * Serves the page's messages, in their order:
 * `{ wasm, blob }` opens a scene;
 * `{ job }` renders one pass over some rows and answers with the sums, which are transferred, not copied.
 */
export function serve() {
    let scene;
    let film;

    async function open({ wasm, blob }) {
        scene = await Scene.open(await load(wasm), blob);
        film = scene.film();
    }

    function render(job) {
        const tile = { y: job.y, height: job.height, first: job.pass, samples: 1 };
        scene.clear(film);
        scene.renderTile(film, tile, { estimator: job.estimator });
        const answer = { job, samples: scene.rows(film.samples, job.y, job.height) };
        const transfer = [answer.samples.buffer];
        if (job.estimator !== "path") {
            answer.splats = scene.rows(film.splats, 0, scene.height);
            transfer.push(answer.splats.buffer);
        }
        postMessage(answer, transfer);
    }

    let before = Promise.resolve();
    onmessage = ({ data }) => {
        before = before
            .then(() => (data.job ? render(data.job) : open(data)))
            .catch((error) => postMessage({ error: error.message }));
    };
}
