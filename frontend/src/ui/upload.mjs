// upload: sends a file of this computer to the folder of the session.

/** Sends a file and returns its name there; rejects with the sentence of the server. */
export async function upload(app, file) {
  const address = `api/${app.connection.session}/upload?${new URLSearchParams({ name: file.name })}`;
  const answer = await fetch(address, { method: "POST", body: file });
  if (!answer.ok) throw new Error(`${file.name}: ${(await answer.text()).trim()}`);
  return (await answer.json()).name;
}
