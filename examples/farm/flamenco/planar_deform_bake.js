// SPDX-License-Identifier: GPL-3.0-or-later
// A Flamenco job type: the in-betweens and point caches of the open shot, one task an object, and a file that plays
// them. It goes to the folder "scripts" beside Flamenco Manager. See docs/farm.md.

const JOB_TYPE = {
    label: "Planar Deform Bake",
    description: "Generate in-betweens and bake point caches, one task an object",
    settings: [
        { key: "objects", type: "string", required: true,
          eval: "__import__('json').dumps([o.name for o in bpy.data.objects"
              + " if o.type == 'MESH' and not o.library and not o.override_library and len(o.planar.poses)])",
          evalInfo: { showLinkButton: true, description: "All that have poses" },
          description: "Names of the objects to bake, as a list of JSON" },
        { key: "generate", type: "bool", default: true,
          description: "Generate the in-betweens first" },
        { key: "shot", type: "string", subtype: "file_path", required: true, visible: "submission",
          eval: "bpy.data.filepath", evalInfo: { showLinkButton: true, description: "The open file" },
          description: "The .blend with the poses, where workers read it; the point caches are put beside it" },
        { key: "baked", type: "string", subtype: "file_path", required: true, visible: "submission",
          eval: "str(Path(bpy.data.filepath).with_suffix('')) + '_baked.blend'",
          evalInfo: { showLinkButton: true, description: "Beside the open file" },
          description: "The .blend to save that plays the point caches" },
    ],
};

function compileJob(job) {
    const settings = job.settings;
    const objects = JSON.parse(settings.objects);
    if (objects.length === 0) {
        throw "There is no object to bake: key poses, or name some objects";
    }
    const gather = task("gather", settings, ["--play", "--save", settings.baked]);
    for (const name of objects) {
        const work = settings.generate ? ["--generate"] : [];
        const bake = task(`bake ${name}`, settings,
            [`--object=${name}`, ...work, "--bake", "POINT_CACHE", "--replace"]);
        job.addTask(bake);
        gather.addDependency(bake);
    }
    job.addTask(gather);
}

function task(name, settings, args) {
    const made = author.Task(name, "blender");
    made.addCommand(author.Command("blender-render", {
        exe: "{blender}",
        exeArgs: "{blenderArgs}",
        argsBefore: [],
        blendfile: settings.shot,
        args: ["--command", "planar", ...args],
    }));
    return made;
}
