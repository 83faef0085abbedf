// SPDX-License-Identifier: Apache-2.0
// Beside the page, so that it does not freeze: each message is a run, and is answered by what fp3 said and wrote.
let module;

const fp3 = (words, files) => makeWasi(["fp3", ...words], files).run(module);

onmessage = ({data}) => {
  if (data.module) {
    module = data.module;
    return;
  }
  try {
    const ran = fp3(["run", ...data.run], data.files);
    const isDone = ran.code === 0 || ran.code === 3, report = isDone ? fp3(["compile", ...data.compile], data.files).out : "";
    postMessage({number: data.number, ran, report});
  } catch (why) {
    postMessage({number: data.number, ran: {code: 1, out: "", err: `fp3 run: ${why.message}`, files: {}}, report: ""});
  }
};
