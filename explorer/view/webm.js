// A film as a file: the browser encodes the frames (WebCodecs), and here they are put into WebM.
//
// An element is its identifier, its length and its content; Matroska's specification lists them (matroska.org).

const FRAMES_PER_SECOND = 30;
const KEY_EVERY = 60; // frames
const CODEC = "vp09.00.41.08"; // VP9, profile 0, level 4.1: 1080 lines at 30 frames a second

const join = (parts) => {
  const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
};

/** A whole number as bytes, the highest first. */
function bytes(value, count = 0) {
  const found = [];
  for (let rest = value; rest > 0 || found.length < count; rest = Math.floor(rest / 256)) found.unshift(rest % 256);
  return Uint8Array.from(found);
}

/** content: a whole number, a text, bytes, or a list of elements. */
function element(id, content) {
  let body = content;
  if (typeof content === "number") body = bytes(content, 1);
  else if (typeof content === "string") body = new TextEncoder().encode(content);
  else if (Array.isArray(content)) body = join(content);
  return join([bytes(id), [0x01], bytes(body.length, 7), body]);
}

/** Frames, each { data, key }, as a WebM file. */
export function webm(frames, width, height, title) {
  const milliseconds = (n) => Math.round((1000 * n) / FRAMES_PER_SECOND);
  const duration = new Uint8Array(new Float64Array([milliseconds(frames.length)]).buffer).reverse();
  const head = element(0x1a45dfa3, [
    element(0x4286, 1), element(0x42f7, 1), element(0x42f2, 4), element(0x42f3, 8),
    element(0x4282, "webm"), element(0x4287, 4), element(0x4285, 2),
  ]);
  const info = element(0x1549a966, [
    element(0x2ad7b1, 1000000), element(0x7ba9, title), element(0x4d80, "nearflat"), element(0x5741, "nearflat"),
    element(0x4489, duration),
  ]);
  const track = element(0x1654ae6b, [element(0xae, [
    element(0xd7, 1), element(0x73c5, 1), element(0x83, 1), element(0x86, "V_VP9"),
    element(0xe0, [element(0xb0, width), element(0xba, height)]),
  ])]);
  const blocks = frames.map(({ data, key }, n) => (
    element(0xa3, join([[0x81], bytes(milliseconds(n), 2), [key ? 0x80 : 0], data]))
  ));
  return join([head, element(0x18538067, [info, track, element(0x1f43b675, [element(0xe7, 0), ...blocks])])]);
}

/** Draws `seconds` of a film, frame by frame, and returns the bytes of a WebM file. draw(context, share). */
export async function record(draw, seconds, width, height, title) {
  const canvas = Object.assign(document.createElement("canvas"), { width, height });
  const context = canvas.getContext("2d"), frames = [];
  let failed = null;
  const encoder = new VideoEncoder({
    output: (chunk) => {
      const data = new Uint8Array(chunk.byteLength);
      chunk.copyTo(data);
      frames.push({ data, key: chunk.type === "key" });
    },
    error: (error) => { failed = error; },
  });
  encoder.configure({ codec: CODEC, width, height, framerate: FRAMES_PER_SECOND, bitrate: 1.8e6 });
  const count = seconds * FRAMES_PER_SECOND;
  for (let n = 0; n < count && !failed; n++) {
    draw(context, n / (count - 1));
    const frame = new VideoFrame(canvas, { timestamp: (1e6 * n) / FRAMES_PER_SECOND });
    encoder.encode(frame, { keyFrame: n % KEY_EVERY === 0 });
    frame.close();
    // The page stays alive, and frames do not pile up before the encoder.
    do await new Promise((done) => setTimeout(done)); while (encoder.encodeQueueSize > 4);
  }
  if (failed) throw failed;
  await encoder.flush();
  return webm(frames, width, height, title);
}
