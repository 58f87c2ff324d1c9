// Dates as a person reads them.

/** Returns day and time of a date, such as "today at 14:05" or "28 Nov at 14:05"; the year only if it is another one. */
export function dayAndTime(date, now = new Date(), locale = undefined) {
  const midnight = (one) => new Date(one.getFullYear(), one.getMonth(), one.getDate()).getTime();
  const days = Math.round((midnight(now) - midnight(date)) / 86_400_000); // rounded, since a day may have 23 or 25 hours
  const year = date.getFullYear() === now.getFullYear() ? {} : { year: "numeric" };
  const day = ["today", "yesterday"][days] ?? date.toLocaleDateString(locale, { day: "numeric", month: "short", ...year });
  return `${day} at ${date.toLocaleTimeString(locale, { timeStyle: "short" })}`;
}
