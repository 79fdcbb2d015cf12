// The stream of all that is live: messages of a head in JSON and a body of bytes, each preceded by its length.

const PAUSE = 1000; // [ms] until it is tried again

export async function follow(take, told) {
  for (;;) {
    try {
      const answer = await fetch("live", { cache: "no-store" });
      if (!answer.ok) throw new Error((await answer.json()).problem);
      told(true, "");
      await read(answer.body.getReader(), take);
      told(false, "the page's server went; trying again …");
    } catch (error) {
      told(false, `no connection (${error.message}); trying again …`);
    }
    await new Promise((done) => setTimeout(done, PAUSE));
  }
}

async function read(reader, take) {
  let parts = [], size = 0, wanted = 8;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return;
    parts.push(value);
    size += value.length;
    while (size >= wanted) {
      const all = parts.length === 1 ? parts[0] : joined(parts, size);
      const view = new DataView(all.buffer, all.byteOffset);
      const head = view.getUint32(0), body = view.getUint32(4);
      wanted = 8 + head + body;
      if (size >= wanted) {
        take(JSON.parse(new TextDecoder().decode(all.subarray(8, 8 + head))), all.slice(8 + head, wanted));
        parts = [all.subarray(wanted)];
        size -= wanted;
        wanted = 8;
      } else {
        parts = [all];
      }
    }
  }
}

function joined(parts, size) {
  const all = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    all.set(part, at);
    at += part.length;
  }
  return all;
}
