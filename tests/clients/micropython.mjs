// MicroPython: node micropython.mjs PROGRAM FILE... runs a program beside files that it may import or read. What it
// writes to stdout is printed in hex, byte by byte as it was.
import { readFileSync } from "node:fs";
import { basename } from "node:path";
import { loadMicroPython } from "@micropython/micropython-webassembly-pyscript/micropython.mjs";

const [program, ...files] = process.argv.slice(2);
const written = [];
const micropython = await loadMicroPython({ stdout: (bytes) => written.push(...bytes), linebuffer: false });
for (const file of files) micropython.FS.writeFile(`/${basename(file)}`, readFileSync(file));
micropython.runPython(readFileSync(program, "utf8"));
process.stdout.write(Buffer.from(written).toString("hex"));
