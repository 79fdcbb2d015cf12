// Requests to the page's server. What changes robots brings the token, which stands behind # in the address that was printed.

const KEPT = "sendworthy-token";

function found() {
  const given = new URLSearchParams(location.hash.slice(1)).get("token");
  if (given) {
    sessionStorage.setItem(KEPT, given);
    // Off the address, so that nobody passes it on by mistake.
    history.replaceState(null, "", location.pathname);
  }
  return sessionStorage.getItem(KEPT);
}

export const token = found();

export async function ask(path, told) {
  const request = told === undefined ? {} : {
    method: "POST",
    headers: { "Content-Type": "application/json", "X-Sendworthy-Token": token ?? "" },
    body: JSON.stringify(told),
  };
  const answer = await fetch(path, request);
  const said = await answer.json();
  if (!answer.ok) throw new Error(said.problem);
  return said;
}
