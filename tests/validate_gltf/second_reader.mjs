// SPDX-License-Identifier: MIT
// node second_reader.mjs HEWER FILE...: reads each file with glTF-Transform and compares the number of
// triangles and the box with what `HEWER info --json` says. Exit code 1 on a difference.
import { execFileSync } from 'node:child_process';

import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import { getBounds } from '@gltf-transform/functions';
import draco3d from 'draco3dgltf';
import { MeshoptDecoder } from 'meshoptimizer';

const kShareOfSize = 1e-4;

function countTriangles(scene) {
    let n = 0;
    const visit = (node) => {
        for (const p of node.getMesh()?.listPrimitives() ?? []) {
            const corners = (p.getIndices() ?? p.getAttribute('POSITION')).getCount();
            if (p.getMode() === 4) n += Math.floor(corners / 3);
            if (p.getMode() === 5 || p.getMode() === 6) n += Math.max(0, corners - 2);
        }
        node.listChildren().forEach(visit);
    };
    scene.listChildren().forEach(visit);
    return n;
}

async function main() {
    const [hewer, ...files] = process.argv.slice(2);
    const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
        'draco3d.decoder': await draco3d.createDecoderModule(),
        'meshopt.decoder': MeshoptDecoder,
    });
    let isEqual = true;
    for (const file of files) {
        const root = (await io.read(file)).getRoot();
        const scene = root.getDefaultScene() ?? root.listScenes()[0];
        const n = countTriangles(scene);
        const box = getBounds(scene);
        const info = JSON.parse(execFileSync(hewer, ['info', '--json', file]).toString());
        const size = Math.max(...box.max.map((x, i) => x - box.min[i]));
        const isNear = (a, b) => a.every((x, i) => Math.abs(x - b[i]) <= kShareOfSize * size);
        const same = n === info.faces && isNear(box.min, info.bounds.min) &&
            isNear(box.max, info.bounds.max);
        console.log(`${file}: ${n} triangles, ${same ? 'as hewer reads it' : `hewer reads ${info.faces}; box ` +
            `${JSON.stringify(box)} and ${JSON.stringify(info.bounds)}`}`);
        isEqual = isEqual && same;
    }
    process.exitCode = isEqual ? 0 : 1;
}

await main();
