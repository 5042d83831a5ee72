// Chromium without a window, by its DevTools protocol over a pipe.
import { spawn } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

// Calls `visit` with a page: `call(method, params)` of the protocol, `evaluate(expression)`, and `complaints`, what scripts threw and what the console calls
// errors. The browser is closed in the end, whatever happens.
export async function browse(visit) {
    const profile = mkdtempSync(join(tmpdir(), "etendue-chromium-"));
    const flags = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe"];
    const browser = spawn("chromium", [...flags, "--window-size=1280,800", `--user-data-dir=${profile}`], {
        stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"],
    });
    const [, , , input, output] = browser.stdio;

    const answers = new Map();
    const complaints = [];
    let text = "";
    output.on("data", (bytes) => {
        text += bytes;
        const messages = text.split("\0");
        text = messages.pop();
        for (const { id, method, params, ...answer } of messages.map((m) => JSON.parse(m))) {
            answers.get(id)?.(answer);
            if (method === "Runtime.exceptionThrown") {
                complaints.push(params.exceptionDetails.exception?.description ?? "an exception");
            } else if (method === "Log.entryAdded" && params.entry.level === "error") {
                complaints.push(params.entry.text);
            }
        }
    });

    let count = 0;
    const send = (method, params, sessionId) => {
        const id = ++count;
        input.write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
        return new Promise((resolve, reject) => {
            answers.set(id, ({ result, error }) =>
                error ? reject(new Error(`${method}: ${error.message}`)) : resolve(result),
            );
        });
    };

    try {
        const { targetId } = await send("Target.createTarget", { url: "about:blank" });
        const { sessionId } = await send("Target.attachToTarget", { targetId, flatten: true });
        const call = (method, params = {}) => send(method, params, sessionId);
        const evaluate = async (expression) => {
            const { result } = await call("Runtime.evaluate", { expression, returnByValue: true, awaitPromise: true });
            return result.value;
        };
        await call("Runtime.enable");
        await call("Log.enable");
        await visit({ call, evaluate, complaints });
    } finally {
        await new Promise((resolve) => {
            browser.on("exit", resolve);
            send("Browser.close").catch(() => browser.kill());
        });
        rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
    }
}
