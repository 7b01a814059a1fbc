// Reads the arrays of an .npz: enough for those that nerf-oracle writes.

import { readFileSync } from "node:fs";
import { inflateRawSync } from "node:zlib";

const TYPES = { "<f8": Float64Array, "<f4": Float32Array, "<i8": BigInt64Array, "|u1": Uint8Array };

/** Names to {shape, values}. */
export function npz(path) {
  const file = readFileSync(path);
  const out = {};
  // The end record says where the central directory starts; its entries say where the files do.
  const end = file.lastIndexOf(Buffer.from("PK\x05\x06", "latin1"));
  let at = file.readUInt32LE(end + 16);
  while (file.readUInt32LE(at) === 0x02014b50) {
    const [method, size] = [file.readUInt16LE(at + 10), file.readUInt32LE(at + 20)];
    const [name, extra, comment] = [28, 30, 32].map((offset) => file.readUInt16LE(at + offset));
    const local = file.readUInt32LE(at + 42);
    const start = local + 30 + file.readUInt16LE(local + 26) + file.readUInt16LE(local + 28);
    const bytes = file.subarray(start, start + size);
    out[file.toString("utf8", at + 46, at + 46 + name).replace(/\.npy$/, "")] = npy(method === 8 ? inflateRawSync(bytes) : bytes);
    at += 46 + name + extra + comment;
  }
  return out;
}

function npy(bytes) {
  const start = 10 + bytes.readUInt16LE(8);
  const header = bytes.toString("latin1", 10, start);
  const [, type] = header.match(/'descr': '([^']+)'/);
  const shape = header.match(/'shape': \(([^)]*)\)/)[1].split(",").filter((n) => n.trim()).map(Number);
  if (!TYPES[type] || header.includes("'fortran_order': True")) throw new Error(`an array that this reader doesn't know: ${header}`);
  const values = new TYPES[type](bytes.buffer.slice(bytes.byteOffset + start, bytes.byteOffset + bytes.length));
  return { shape, values: Array.from(values, Number) };
}
