# godot3-server --path project -s test.gd: the class without a window.
extends SceneTree

func expect(condition, what):
	if not condition:
		printerr("godot: failed: " + what)
		OS.exit_code = 1
	return condition

func texture(face):
	var file = File.new()
	expect(file.open(OS.get_environment("FASCIA_HEAD"), File.READ) == OK, "the head can be read")
	expect(face.load(file.get_buffer(file.get_len()), 0), "the head is loaded")
	var textured = 0
	for mesh in range(face.mesh_count()):
		var least = Vector2(1, 1)
		var most = Vector2(0, 0)
		var texcoords = face.texcoords(mesh)
		for place in texcoords:
			least = Vector2(min(least.x, place.x), min(least.y, place.y))
			most = Vector2(max(most.x, place.x), max(most.y, place.y))
		if face.part(mesh) == "skin" and texcoords.size() == face.positions(mesh).size() and (most - least).length() > 0.1:
			textured += 1
	expect(textured > 0, "the skin has texture coordinates")

func _init():
	var face = load("res://fascia_face.gdns").new()
	expect(not face.load(PoolByteArray([1, 2, 3])), "rubbish is refused")
	var file = File.new()
	expect(file.open(OS.get_environment("FASCIA_RIG"), File.READ) == OK, "the rig can be read")
	expect(face.load(file.get_buffer(file.get_len()), 0), "the rig is loaded")
	var skin = -1
	for mesh in range(face.mesh_count()):
		if face.part(mesh) == "skin" and skin < 0:
			skin = mesh
	var rest = face.positions(skin)
	expect(rest.size() > 100 and face.triangles(skin).size() > 100 and face.normals(skin).size() == rest.size(), "arrays")
	expect(not face.set_value("no such thing", 1.0), "an unknown name is refused")
	expect(face.set_value("arkit:mouthSmileLeft", 1.0), "a name is known")
	for frame in range(30):
		expect(face.step(1.0 / 60.0), "a step")
	var posed = face.positions(skin)
	var most = 0.0
	for vertex in range(rest.size()):
		most = max(most, (posed[vertex] - rest[vertex]).length())
	expect(most > 0.0, "it moves")
	face.clear()
	face.reset()
	posed = face.positions(skin)
	for vertex in range(rest.size()):
		if not expect(posed[vertex] == rest[vertex], "rest is rest"):
			break
	expect(face.texcoords(skin).size() in [0, rest.size()], "texture coordinates of all vertices or none")
	if OS.has_environment("FASCIA_HEAD"):  # a whole head with texture coordinates
		texture(load("res://fascia_face.gdns").new())
	if OS.exit_code == 0:
		print("godot: %d meshes, all passed" % face.mesh_count())
	quit()
