// SPDX-License-Identifier: BSD-3-Clause
// Prints what the validator of Khronos (npm: gltf-validator) says of a file: node validate_glb.mjs FILE, in the folder of
// its node_modules.
import {createRequire} from 'node:module';
import {readFileSync} from 'node:fs';

const validator = createRequire(process.cwd() + '/')('gltf-validator');
const report = await validator.validateBytes(new Uint8Array(readFileSync(process.argv[2])), {maxIssues: 20});
const {numErrors: errors, numWarnings: warnings, numInfos: infos, messages} = report.issues;
const {totalVertexCount: vertices, totalTriangleCount: triangles} = report.info ?? {};
console.log(JSON.stringify({errors, warnings, infos, vertices, triangles, messages: messages.map(({code, message}) => `${code}: ${message}`)}));
