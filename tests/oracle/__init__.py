"""Independent reference results, to 50 digits and on the continuous time axis; nothing here imports `motionsync`."""
