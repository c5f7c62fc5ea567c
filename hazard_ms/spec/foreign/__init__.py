"""The one gate for files that somebody else may have made: results, journals, datasets, pictures, weights, caches.

    files     bytes of regular files up to a limit, names that stay inside a folder, text that is safe on a terminal
    plain     JSON with limits on size, depth and numbers, and dataclasses from it by their types
    hooks     what the decoder of JSON is told: numbers that are finite and short, keys that differ
    arrays    .npz files and zip archives, whose sizes are compared with a limit before anything is unpacked
    archives  zip archives of files: names stay inside, members are regular, few, and as large as they announce
    terminal  the output of a command without what a terminal would act on
    pictures  PNG and JPEG files, whose pixels are counted before anything is decoded

Everything that is wrong with a file is one ValueError that names the file. Nothing that a file names is imported, run
or followed out of its folder.
"""
