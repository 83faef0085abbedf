// SPDX-License-Identifier: Apache-2.0
// WASI for one program: its words, its clock, and files in memory; what it writes is there when it ends.
// makeWasi(words, files).run(module) -> {code, out, err, files}: files map names to bytes.
const makeWasi = (words, given) => {
  const files = new Map(Object.entries(given)), text = new TextEncoder(), streams = ["", "", ""];
  const [BADF, EXIST, INVAL, NOENT, NOSYS, SPIPE] = [8, 20, 28, 44, 52, 70], ROOT = 3, open = new Map();
  const decoders = [null, new TextDecoder(), new TextDecoder()];
  let memory, next = ROOT + 1;
  class Exit { constructor(code) { this.code = code; } }
  const view = () => new DataView(memory.buffer), bytes = (at, size) => new Uint8Array(memory.buffer, at, size);
  const name = (at, size) => new TextDecoder().decode(bytes(at, size).slice()).replace(/^(\.?\/)+/, "") || ".";
  const put32 = (at, value) => (view().setUint32(at, value, true), 0);
  const put64 = (at, value) => (view().setBigUint64(at, BigInt(value), true), 0);

  const list = (items, at, buffer) => {
    for (const item of items) {
      const data = text.encode(item + "\0");
      put32(at, buffer);
      bytes(buffer, data.length).set(data);
      [at, buffer] = [at + 4, buffer + data.length];
    }
    return 0;
  };
  const sizes = (items, count, size) => put32(count, items.length) || put32(size, items.reduce((sum, item) => sum + text.encode(item).length + 1, 0));

  // A type of 3 is a directory, 4 a file, 2 a stream.
  const stat = (at, type, inode, size) => {
    bytes(at, 64).fill(0);
    view().setUint8(at + 16, type);
    put64(at + 8, inode);
    put64(at + 24, 1);
    return put64(at + 32, size);
  };
  const inodes = new Map();
  const inode = file => inodes.get(file) || (inodes.set(file, inodes.size + 10), inodes.get(file));
  const each = (vectors, count, take) => {
    let done = 0;
    for (let i = 0; i < count; i++) {
      const at = view().getUint32(vectors + 8 * i, true), size = view().getUint32(vectors + 8 * i + 4, true), part = take(at, size);
      done += part;
      if (part < size) break;
    }
    return done;
  };
  const grow = (file, size) => {
    if (size > file.data.length) {
      const more = new Uint8Array(Math.max(size, 2 * file.data.length));
      more.set(file.data.subarray(0, file.size));
      file.data = more;
    }
    file.size = Math.max(file.size, size);
  };
  const stored = at => {
    const found = files.get(at);
    if (found instanceof Uint8Array) files.set(at, {data: found, size: found.length});
    return files.get(at);
  };

  const calls = {
    args_get: (at, buffer) => list(words, at, buffer),
    args_sizes_get: (count, size) => sizes(words, count, size),
    environ_get: () => 0,
    environ_sizes_get: (count, size) => sizes([], count, size),
    clock_time_get: (id, precision, at) => put64(at, Math.round((id ? performance.now() : Date.now()) * 1e6)),
    proc_exit: code => { throw new Exit(code); },
    fd_close: fd => open.delete(fd) ? 0 : fd < 3 ? 0 : BADF,
    fd_fdstat_get: (fd, at) => {
      if (fd > ROOT && !open.has(fd)) return BADF;
      bytes(at, 24).fill(0);
      view().setUint8(at, fd < 3 ? 2 : fd === ROOT ? 3 : 4);
      return put64(at + 8, 0x1fffffff) || put64(at + 16, 0x1fffffff);
    },
    fd_fdstat_set_flags: () => 0,
    fd_filestat_get: (fd, at) => fd < 3 ? stat(at, 2, 1, 0) : fd === ROOT ? stat(at, 3, 2, 0) : !open.has(fd) ? BADF : stat(at, 4, inode(open.get(fd).file), open.get(fd).file.size),
    fd_prestat_get: (fd, at) => fd === ROOT ? put32(at, 0) || put32(at + 4, 1) : BADF,
    fd_prestat_dir_name: (fd, at) => (bytes(at, 1)[0] = 47, 0),
    fd_read: (fd, vectors, count, done) => {
      const handle = open.get(fd);
      if (!handle) return fd === 0 ? put32(done, 0) : BADF;
      return put32(done, each(vectors, count, (at, size) => {
        const part = handle.file.data.subarray(handle.at, Math.min(handle.file.size, handle.at + size));
        bytes(at, part.length).set(part);
        handle.at += part.length;
        return part.length;
      }));
    },
    fd_write: (fd, vectors, count, done) => {
      const handle = open.get(fd);
      if (!handle && fd !== 1 && fd !== 2) return BADF;
      return put32(done, each(vectors, count, (at, size) => {
        if (handle) {
          grow(handle.file, handle.at + size);
          handle.file.data.set(bytes(at, size), handle.at);
          handle.at += size;
        } else streams[fd] += decoders[fd].decode(bytes(at, size).slice(), {stream: true});
        return size;
      }));
    },
    fd_seek: (fd, offset, whence, at) => {
      const handle = open.get(fd);
      if (!handle) return fd < 3 ? SPIPE : BADF;
      const to = Number(offset) + [0, handle.at, handle.file.size][whence];
      if (to < 0) return INVAL;
      handle.at = to;
      return put64(at, to);
    },
    fd_sync: () => 0,
    path_open: (fd, flags, at, size, how, rights, inherited, mode, result) => {
      const path = name(at, size);
      let file = stored(path);
      if (file && (how & 5) === 5) return EXIST;
      if (!file && !(how & 1)) return NOENT;
      if (!file) files.set(path, file = {data: new Uint8Array(4096), size: 0});
      if (how & 8) file.size = 0;
      open.set(next, {file, at: 0});
      return put32(result, next++);
    },
    path_filestat_get: (fd, flags, at, size, result) => {
      const path = name(at, size), file = stored(path);
      return path === "." ? stat(result, 3, 2, 0) : file ? stat(result, 4, inode(file), file.size) : NOENT;
    },
    path_rename: (fd, at, size, to, toAt, toSize) => {
      const path = name(at, size), file = stored(path);
      if (!file) return NOENT;
      files.delete(path);
      files.set(name(toAt, toSize), file);
      return 0;
    },
    path_unlink_file: (fd, at, size) => files.delete(name(at, size)) ? 0 : NOENT,
    path_readlink: (fd, at, size) => files.has(name(at, size)) ? INVAL : NOENT,
    sched_yield: () => 0,
  };
  const run = module => {
    let code = 0;
    const wanted = Object.fromEntries(WebAssembly.Module.imports(module).map(one => [one.name, calls[one.name] || (() => NOSYS)]));
    const instance = new WebAssembly.Instance(module, {wasi_snapshot_preview1: wanted});
    memory = instance.exports.memory;
    try {
      instance.exports._start();
    } catch (why) {
      if (!(why instanceof Exit)) throw why;
      code = why.code;
    }
    const made = {};
    for (const [path, file] of files) made[path] = file instanceof Uint8Array ? file : file.data.slice(0, file.size);
    return {code, out: streams[1], err: streams[2], files: made};
  };
  return {run};
};
