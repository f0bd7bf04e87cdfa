// Files that were chosen or dropped, as texts. A dropped folder gives its specification and its tables.
// Characters of a text as it is sent, where each end of a line has two: the server takes a megabyte.
export const LARGEST = 900_000;
const MOST = 40;          // files of a folder

// The length of a text in a message.
export const sent = (text) => JSON.stringify(text).length;

async function textOf(file) {
  const large = { name: file.name, why: `is larger than ${LARGEST / 1000} kB, the limit for a file` };
  if (file.size > LARGEST) return large;
  try {
    const text = new TextDecoder("utf-8", { fatal: true }).decode(await file.arrayBuffer());
    return sent(text) > LARGEST ? large : { name: file.name, text };
  } catch (error) {
    return { name: file.name, why: error instanceof TypeError ? "is not a text in UTF-8" : "could not be read" };
  }
}

const inFolder = (entry) => new Promise((done) => {
  const [reader, found] = [entry.createReader(), []];
  const next = () => reader.readEntries((entries) => {
    found.push(...entries);
    if (entries.length && found.length < 1000) next();
    else done(found.filter((each) => each.isFile && /^spec\.toml$|\.csv$/i.test(each.name)).slice(0, MOST));
  }, () => done(found));
  next();
});

export async function textsIn(folder) {
  const found = await inFolder(folder);
  if (!found.some((entry) => entry.name.toLowerCase() === "spec.toml")) return [{ name: folder.name, why: "is a folder without a spec.toml" }];
  return textsOf(await Promise.all(found.map((entry) => new Promise((done, failed) => entry.file(done, failed)))));
}

// Those that cannot be read say why; together they fit into one message, the specification first.
export async function textsOf(files) {
  const texts = await Promise.all([...files].slice(0, MOST).map(textOf));
  texts.sort((one, other) => /\.toml$/i.test(other.name) - /\.toml$/i.test(one.name));
  let room = LARGEST;
  return texts.map((each) => {
    const size = sent(each.text ?? "");
    if (size > room) return { name: each.name, why: `is too large beside the others, which may have ${LARGEST / 1000} kB together` };
    room -= size;
    return each;
  });
}
