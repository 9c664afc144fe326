# A head in a scene: the rig is rig.glb beside the project, or FASCIA_RIG. With FASCIA_PICTURE it smiles, saves a picture and ends.
extends Spatial

const FasciaFace = preload("res://fascia_face.gdns")

var face = FasciaFace.new()
var meshes = []
var seconds = 0.0
var skin_picture = null

func _ready():
	var file = File.new()
	var path = OS.get_environment("FASCIA_RIG") if OS.has_environment("FASCIA_RIG") else "res://rig.glb"
	if file.open(path, File.READ) != OK:
		push_error(path + " cannot be read")
		get_tree().quit(1)
		return
	if not face.load(file.get_buffer(file.get_len()), 0):
		get_tree().quit(1)
		return
	skin_picture = _picture(path.get_base_dir().plus_file("head_skin.jpg"))
	var box = AABB()
	for mesh in range(face.mesh_count()):
		var instance = MeshInstance.new()
		instance.mesh = ArrayMesh.new()
		add_child(instance)
		meshes.append(instance.mesh)
		instance.material_override = _material(face.part(mesh), face.name(mesh))
		_write(mesh)
		box = instance.mesh.get_aabb() if mesh == 0 else box.merge(instance.mesh.get_aabb())
	var size = box.size.length()
	var centre = box.position + box.size / 2
	var camera = Camera.new()
	add_child(camera)
	camera.far = size * 20
	camera.near = size / 100
	camera.fov = 30
	camera.look_at_from_position(centre + Vector3(0.35, 0.05, 1).normalized() * size * 1.6, centre, Vector3.UP)
	camera.current = true
	for direction in [Vector3(-0.5, -0.6, -0.7), Vector3(0.8, -0.1, -0.5)]:
		var light = DirectionalLight.new()
		add_child(light)
		light.look_at(direction, Vector3.UP)
		light.light_energy = 0.7

func _picture(path):
	var image = Image.new()
	if not File.new().file_exists(path) or image.load(path) != OK:
		return null
	var texture = ImageTexture.new()
	texture.create_from_image(image)
	return texture

func _material(part, name):
	var material = SpatialMaterial.new()
	var colours = {"skin": Color(0.8, 0.62, 0.54), "iris": Color(0.33, 0.43, 0.49), "pupil": Color(0.02, 0.02, 0.02),
			"lashes": Color(0.1, 0.08, 0.06), "mouth_interior": Color(0.68, 0.36, 0.35)}
	material.albedo_color = colours.get(name, colours.get(part, Color(0.92, 0.9, 0.86)))
	if part == "skin" and skin_picture != null:
		material.albedo_color = Color(1, 1, 1)
		material.albedo_texture = skin_picture
	material.roughness = 0.6
	return material

func _write(mesh):
	var arrays = []
	arrays.resize(ArrayMesh.ARRAY_MAX)
	arrays[ArrayMesh.ARRAY_VERTEX] = face.positions(mesh)
	arrays[ArrayMesh.ARRAY_NORMAL] = face.normals(mesh)
	var texcoords = face.texcoords(mesh)
	if texcoords.size() > 0:
		arrays[ArrayMesh.ARRAY_TEX_UV] = texcoords
	arrays[ArrayMesh.ARRAY_INDEX] = face.triangles(mesh)
	while meshes[mesh].get_surface_count() > 0:
		meshes[mesh].surface_remove(0)
	meshes[mesh].add_surface_from_arrays(Mesh.PRIMITIVE_TRIANGLES, arrays)

func _process(delta):
	seconds += delta
	for name in ["mouthSmileLeft", "mouthSmileRight"]:
		face.set_value("arkit:" + name, 0.5 - 0.5 * cos(2.0 * seconds) if not OS.has_environment("FASCIA_PICTURE") else 1.0)
	face.step(min(delta, 0.1))
	for mesh in range(meshes.size()):
		_write(mesh)
	if OS.has_environment("FASCIA_PICTURE") and seconds > 1.0:
		var picture = get_viewport().get_texture().get_data()
		picture.flip_y()
		get_tree().quit(0 if picture.save_png(OS.get_environment("FASCIA_PICTURE")) == OK else 1)
