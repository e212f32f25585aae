// SPDX-License-Identifier: MIT
// node draco_readers.mjs HEWER FOLDER FILE...: decodes each .drc, and each primitive of each GLB with
// Draco compression, with draco3dgltf and with draco_decoder (its files go to FOLDER), and compares the
// numbers of faces, and of points as draco3dgltf has them, with what `HEWER info --check --json` says.
// Exit code 1 on a difference. draco_decoder writes OBJ: its PLY breaks off at 16-bit colours, and has
// no more faces then.
import { execFileSync } from 'node:child_process';
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

import draco3d from 'draco3dgltf';

const kDraco = 'KHR_draco_mesh_compression';

// The Draco data in a file.
function payloadsOf(file) {
    const bytes = readFileSync(file);
    if (bytes.toString('latin1', 0, 4) !== 'glTF') return [bytes];
    const jsonLength = bytes.readUInt32LE(12);
    const document = JSON.parse(bytes.toString('utf8', 20, 20 + jsonLength));
    const binary = bytes.subarray(20 + jsonLength + 8);
    return document.meshes.flatMap((mesh) => mesh.primitives).map((primitive) => {
        const view = document.bufferViews[primitive.extensions[kDraco].bufferView];
        const offset = view.byteOffset ?? 0;
        return binary.subarray(offset, offset + view.byteLength);
    });
}

function countByLibrary(module, payload) {
    const decoder = new module.Decoder();
    const mesh = new module.Mesh();
    const status = decoder.DecodeArrayToMesh(new Int8Array(payload), payload.length, mesh);
    if (!status.ok()) throw new Error(status.error_msg());
    const counts = { faces: mesh.num_faces(), vertices: mesh.num_points() };
    module.destroy(mesh);
    module.destroy(decoder);
    return counts;
}

function countFacesByProgram(folder, payload) {
    const packed = join(folder, 'payload.drc');
    const plain = join(folder, 'payload.obj');
    writeFileSync(packed, payload);
    execFileSync('draco_decoder', ['-i', packed, '-o', plain]);
    return readFileSync(plain, 'latin1').split('\n').filter((line) => line.startsWith('f ')).length;
}

function sum(all) {
    return all.reduce((a, b) => ({ faces: a.faces + b.faces, vertices: a.vertices + b.vertices }));
}

async function main() {
    const [hewer, folder, ...files] = process.argv.slice(2);
    const module = await draco3d.createDecoderModule();
    let isEqual = true;
    for (const file of files) {
        const payloads = payloadsOf(file);
        const library = sum(payloads.map((p) => countByLibrary(module, p)));
        const program = payloads.map((p) => countFacesByProgram(folder, p)).reduce((a, b) => a + b);
        const info = JSON.parse(execFileSync(hewer, ['info', '--check', '--json', file]).toString());
        const same = library.faces === info.faces && library.vertices === info.vertices &&
            program === info.faces;
        console.log(`${file}: ${info.faces} faces, ${info.vertices} points, ${same ? 'as both decoders read it' :
            `draco3dgltf ${JSON.stringify(library)}, draco_decoder ${program} faces`}`);
        isEqual = isEqual && same;
    }
    process.exitCode = isEqual ? 0 : 1;
}

await main();
