// SPDX-License-Identifier: MIT
// node validate.cjs FILE...: what the Khronos validator says of each file, one line a message.
// Exit code 1 on any error or warning; infos and hints are listed only. NODE_PATH must lead to
// gltf-validator (scripts/check-gltf sees to it).
'use strict';

const folder = require('path');
const fs = require('fs');
const validator = require('gltf-validator');

const kSeverities = ['error', 'warning', 'info', 'hint'];

async function validate(path) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(path)), {
        uri: path,
        maxIssues: 100,
        externalResourceFunction: async (uri) => new Uint8Array(
            fs.readFileSync(folder.resolve(folder.dirname(path), decodeURIComponent(uri)))),
    });
    const { numErrors, numWarnings, numInfos, numHints, messages, truncated } = report.issues;
    console.log(`${path}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} infos, ` +
        `${numHints} hints; ${report.info.totalVertexCount} vertices, ` +
        `${report.info.totalTriangleCount} triangles`);
    for (const m of messages) {
        console.log(`  ${kSeverities[m.severity]} ${m.code} at ${m.pointer ?? m.offset}: ${m.message}`);
    }
    if (truncated) console.log('  and more');
    return numErrors + numWarnings === 0;
}

async function main() {
    let isValid = true;
    for (const path of process.argv.slice(2)) {
        try {
            isValid = await validate(path) && isValid;
        } catch (error) {
            console.log(`${path}: ${error.message ?? error}`);
            isValid = false;
        }
    }
    process.exitCode = isValid ? 0 : 1;
}

main();
