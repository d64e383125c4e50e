// Files and folders that were dropped on the page.

/** All of them, with their paths below what was dropped. What stands in the transfer is read at once: it is gone later. */
export async function droppedFiles(transfer: DataTransfer): Promise<[string, File][]> {
  const dropped = [...transfer.items].map((item) => item.webkitGetAsEntry() ?? item.getAsFile());
  const files: [string, File][] = [];
  for (const one of dropped) {
    if (one instanceof File) files.push([one.name, one]);
    else if (one !== null) await gather(one, one.name, files);
  }
  return files;
}

async function gather(entry: FileSystemEntry, path: string, files: [string, File][]): Promise<void> {
  if (entry.isFile) {
    const file = await new Promise<File>((done, failed) => (entry as FileSystemFileEntry).file(done, failed));
    files.push([path, file]);
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  for (;;) {
    // It lists some at a time.
    const some = await new Promise<FileSystemEntry[]>((done, failed) => reader.readEntries(done, failed));
    if (some.length === 0) return;
    for (const one of some) await gather(one, `${path}/${one.name}`, files);
  }
}
