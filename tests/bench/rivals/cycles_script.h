#pragma once

namespace hdr::bench {

/// blender -b -P SCRIPT -- FOLDER WIDTH HEIGHT THREADS FOV EYE LOOK SAMPLES...
/// Reads FOLDER/mesh.txt (number of vertices and triangles; of a vertex its place and normal, 0 of flat meshes; of a
/// triangle its vertices and 1 where it is smooth) and FOLDER/map.exr; writes FOLDER/SAMPLES.exr, and a line
/// "RENDER samples cpu wall" each on stdout. The map's pixels are constants, as ours: Closest.
inline constexpr const char* kCyclesScript = R"py(
import bpy, sys, time, math, mathutils, addon_utils
a = sys.argv[sys.argv.index('--') + 1:]
folder, width, height, threads, fov = a[0], int(a[1]), int(a[2]), int(a[3]), float(a[4])
eye, look = [mathutils.Vector([float(v) for v in t.split(',')]) for t in a[5:7]]
bpy.ops.wm.read_factory_settings(use_empty=True)
addon_utils.enable('cycles')
lines = open(folder + '/mesh.txt').read().split('\n')
nv, nf = map(int, lines[0].split())
numbers = [tuple(map(float, l.split())) for l in lines[1:1 + nv]]
verts = [n[:3] for n in numbers]
faces = [tuple(map(int, l.split())) for l in lines[1 + nv:1 + nv + nf]]
mesh = bpy.data.meshes.new('m')
mesh.from_pydata(verts, [], [f[:3] for f in faces])
for p, f in zip(mesh.polygons, faces): p.use_smooth = bool(f[3])
mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.pi
mesh.normals_split_custom_set_from_vertices([n[3:] for n in numbers])
ob = bpy.data.objects.new('o', mesh)
S = bpy.context.scene
S.collection.objects.link(ob)
mat = bpy.data.materials.new('grey')
mat.use_nodes = True
nt = mat.node_tree
nt.nodes.clear()
out, b = nt.nodes.new('ShaderNodeOutputMaterial'), nt.nodes.new('ShaderNodeBsdfDiffuse')
b.inputs['Color'].default_value = (.5, .5, .5, 1)
nt.links.new(b.outputs[0], out.inputs[0])
mesh.materials.append(mat)
w = bpy.data.worlds.new('w')
S.world = w
w.use_nodes = True
env = w.node_tree.nodes.new('ShaderNodeTexEnvironment')
env.image = bpy.data.images.load(folder + '/map.exr')
env.image.colorspace_settings.name = 'Linear'
env.interpolation = 'Closest'
w.node_tree.links.new(env.outputs[0], w.node_tree.nodes['Background'].inputs[0])
w.cycles.sampling_method = 'AUTOMATIC'
c = bpy.data.cameras.new('c')
co = bpy.data.objects.new('c', c)
S.collection.objects.link(co)
S.camera = co
co.location = eye
co.rotation_euler = (look - eye).to_track_quat('-Z', 'Y').to_euler()
c.sensor_fit, c.angle, c.clip_start, c.clip_end = 'HORIZONTAL', math.radians(fov), 1e-3, 1e6
R, C = S.render, S.cycles
R.engine = 'CYCLES'
R.resolution_x, R.resolution_y, R.resolution_percentage = width, height, 100
R.threads_mode, R.threads, R.film_transparent = 'FIXED', threads, True
C.pixel_filter_type, C.filter_width = 'BOX', 1.0
C.use_denoising = C.use_adaptive_sampling = False
C.sample_clamp_direct = C.sample_clamp_indirect = 0
C.max_bounces = C.diffuse_bounces = C.glossy_bounces = 0
C.light_sampling_threshold = 0
I = R.image_settings
I.file_format, I.color_depth, I.exr_codec, I.color_mode = 'OPEN_EXR', '32', 'ZIP', 'RGBA'
S.view_settings.view_transform = 'Standard'
C.samples = 1
bpy.ops.render.render()
for n in map(int, a[7:]):
    C.samples = n
    cpu, wall = time.process_time(), time.time()
    bpy.ops.render.render()
    print('RENDER', n, time.process_time() - cpu, time.time() - wall, flush=True)
    bpy.data.images['Render Result'].save_render('%s/%d.exr' % (folder, n))
)py";

}  // namespace hdr::bench
