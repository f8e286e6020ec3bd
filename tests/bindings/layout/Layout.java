// Prints the layout of every struct as JNA has it.
import com.sun.jna.Structure;
import io.packcell.Raw;
import java.lang.reflect.Field;
import java.lang.reflect.Method;
import java.lang.reflect.Modifier;

public final class Layout {
    public static void main(String[] arguments) throws ReflectiveOperationException {
        Method offset = Structure.class.getDeclaredMethod("fieldOffset", String.class);
        offset.setAccessible(true);
        for (Class<?> type : Raw.STRUCTS) {
            Structure struct = (Structure) type.getDeclaredConstructor().newInstance();
            System.out.println(type.getSimpleName() + " " + struct.size());
            for (Field field : type.getDeclaredFields()) {
                if (!Modifier.isStatic(field.getModifiers())) {
                    System.out.println(type.getSimpleName() + "." + field.getName() + " "
                            + offset.invoke(struct, field.getName()));
                }
            }
        }
    }
}
